#include "engine/projects/import_sparse.h"

#include <algorithm>
#include <chrono>
#include <span>

#include "engine/base/error.h"
#include "engine/formats/zarr/consolidated.h"
#include "engine/formats/zarr/zarr_codec.h"
#include "engine/projects/atomic_folder.h"
#include "engine/projects/foreign_content.h"
#include "engine/projects/import_files.h"
#include "engine/projects/levels/import_cube.h"
#include "engine/projects/part_folder.h"
#include "engine/volume/stored_chunks.h"
#include "engine/volume/voxel_dispatch.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// If more than 1 / MIN_GAIN of all chunks is stored, a dense import with all threads is as fast as a sparse one.
constexpr int64_t MIN_GAIN = 8;

Size3 chunk_counts(const Size3& size)
{
    return (size + (IMPORT_CHUNK - 1)) / IMPORT_CHUNK;
}

Size3 ancestor(const Size3& chunk, int levels)
{
    return {chunk.x >> levels, chunk.y >> levels, chunk.z >> levels};
}

struct SparseLevelFiles {
    int levels = 1;
    int64_t chunks = 0;  ///< number of chunks in all levels
    int64_t stored = 0;  ///< number of chunks that have a file
    int64_t bytes = 0;   ///< total size of the chunks' files and of metadata
};

/// Makes the non-empty chunks of a level and of all finer levels depth-first, so that memory holds only one chunk per
/// level.
template <class T>
class Levels {
public:
    Levels(const VolumeSource& source, const VolumeInfo& info, int levels, const fs::path& folder,
           OmeZarrVersion version, const ZarrCompressor& compressor, const Progress& progress)
        : source_(source), info_(info), compressor_(compressor), progress_(progress), half_(IMPORT_CHUNK / 2)
    {
        written_.levels = levels;
        for (int level = 0; level < written_.levels; ++level) {
            volumes_.push_back(import_level(folder, info, level, version, compressor, false));
            cubes_.emplace_back(IMPORT_CHUNK);
            const Size3 counts = chunk_counts(size_of_level(info.size, level));
            written_.chunks += counts.x * counts.y * counts.z;
            const std::string metadata = to_text(volumes_.back().metadata());
            const fs::path file = folder / std::to_string(level) / volumes_.back().metadata().key();
            write_part_file(file, std::as_bytes(std::span(metadata)));
            written_.bytes += int64_t(metadata.size());
        }
    }

    SparseLevelFiles write(const std::vector<Size3>& chunks)
    {
        all_ = double(chunks.size());
        const int top = written_.levels - 1;
        std::span<const Size3> rest(chunks);
        while (!rest.empty()) make(top, take_below(rest, top));
        return written_;
    }

private:
    /// Removes from `rest` its first chunks that have a common ancestor `levels` levels above, and returns them.
    static std::span<const Size3> take_below(std::span<const Size3>& rest, int levels)
    {
        const Size3 above = ancestor(rest.front(), levels);
        const auto end = std::ranges::find_if(rest, [&](const Size3& each) { return ancestor(each, levels) != above; });
        const auto count = size_t(end - rest.begin());
        const std::span<const Size3> taken = rest.first(count);
        rest = rest.subspan(count);
        return taken;
    }

    /// `below`: the stored chunks of level 0 that the chunk to be made covers; at least one.
    void make(int level, std::span<const Size3> below)
    {
        const Size3 chunk = ancestor(below.front(), level), origin = chunk * IMPORT_CHUNK;
        ImportCube<T>& cube = cubes_[size_t(level)];
        cube.extent = glm::min(Size3(IMPORT_CHUNK), size_of_level(info_.size, level) - origin);
        std::ranges::fill(cube.values, T{});
        if (level == 0) {
            read(origin, cube);
            tell(progress_, double(done_++) / all_);
        } else {
            while (!below.empty()) {
                const std::span<const Size3> part = take_below(below, level - 1);
                make(level - 1, part);
                put_half(cubes_[size_t(level - 1)], ancestor(part.front(), level - 1) - chunk * int64_t{2}, cube);
            }
        }
        write_chunk(level, chunk, std::as_bytes(std::span(cube.values)));
    }

    void read(const Size3& origin, ImportCube<T>& cube)
    {
        const Size3& extent = cube.extent;
        voxels_.resize(size_t(extent.x * extent.y * extent.z));
        source_.read({origin, origin + extent}, std::as_writable_bytes(std::span(voxels_)));
        const T* from = voxels_.data();
        for (int64_t z = 0; z < extent.z; ++z)
            for (int64_t y = 0; y < extent.y; ++y, from += extent.x)
                std::copy_n(from, extent.x, cube.values.data() + cube.row(y, z));
    }

    void put_half(const ImportCube<T>& fine, const Size3& octant, ImportCube<T>& cube)
    {
        halve_cube(fine, half_, Halving::label, CubeRanges::none);
        const Size3 to = octant * (IMPORT_CHUNK / 2);
        for (int64_t z = 0; z < half_.extent.z; ++z)
            for (int64_t y = 0; y < half_.extent.y; ++y)
                std::copy_n(half_.values.data() + half_.row(y, z), half_.extent.x,
                            cube.values.data() + cube.row(to.y + y, to.z + z) + to.x);
    }

    void write_chunk(int level, const Size3& chunk, std::span<const std::byte> voxels)
    {
        if (std::ranges::all_of(voxels, [](std::byte byte) { return byte == std::byte{0}; })) return;
        const auto stored = compress_chunk(compressor_, voxels, sizeof(T), compressed_);
        write_part_file(volumes_[size_t(level)].path_of(chunk), stored);
        ++written_.stored;
        written_.bytes += int64_t(stored.size());
    }

    const VolumeSource& source_;
    const VolumeInfo& info_;
    const ZarrCompressor& compressor_;
    const Progress& progress_;
    std::vector<ZarrVolume> volumes_;  ///< only provide names and paths; never read
    std::vector<ImportCube<T>> cubes_;
    ImportCube<T> half_;
    std::vector<T> voxels_;
    std::vector<std::byte> compressed_;
    SparseLevelFiles written_;
    int64_t done_ = 0;
    double all_ = 1.0;
};

/// Creates the files of all levels in a folder.
SparseLevelFiles write_levels(const VolumeSource& source, const VolumeInfo& info, int levels,
                              const std::vector<Size3>& chunks, const fs::path& folder, OmeZarrVersion version,
                              const ZarrCompressor& compressor, const Progress& progress)
{
    return with_voxel_type(info.type, [&]<class T>(T) {
        return Levels<T>(source, info, levels, folder, version, compressor, progress).write(chunks);
    });
}

/// Writes a small file, and returns its size.
int64_t write_text(const fs::path& path, const std::string& text)
{
    write_part_file(path, std::as_bytes(std::span(text)));
    return int64_t(text.size());
}

struct WrittenImage {
    ImportReport report;
    std::string kept;  ///< the message that save_label_image returns
};

std::string kept_in_words(const fs::path& image, const ForeignContent& content, const fs::path& old)
{
    return sentence(
        image.string(), ": held ", in_words(content.names),
        " of another program; expected only what SHVR writes, since a save replaces the folder: the old one "
        "is kept as ",
        old.string(), ", copy from there what is still needed");
}

std::string replaced_in_words(const fs::path& image, const fs::path& old)
{
    return sentence(image.string(),
                    ": was written by another program; expected it as this one knows it; it is kept as ", old.string(),
                    ", and what is saved is this program's");
}

/// Writes a whole image. `attributes(folder)`: returns the image's attributes if its levels are in `folder`.
WrittenImage write_image(const VolumeSource& source, const VolumeInfo& info, int levels, const fs::path& target,
                         const std::vector<Size3>& chunks, const ImportOptions& options,
                         const std::function<std::string(const std::string& folder)>& attributes,
                         const Progress& progress, Foreign foreign)
{
    if (foreign == Foreign::refused) expect_no_foreign_content(target);
    const OmeZarrVersion version = options.version.value_or(OmeZarrVersion::v0_4);
    AtomicFolder folder(target);
    const std::string inner = folder.inner().empty() ? std::string() : folder.inner() + "/";
    const SparseLevelFiles written =
        write_levels(source, info, levels, chunks, folder.path() / inner, version, options.compressor, progress);
    ImportReport report{.project = target,
                        .info = info,
                        .levels = written.levels,
                        .bricks = written.chunks,
                        .bricks_stored = written.stored,
                        .bytes = written.bytes,
                        .warnings = source.info().warnings};
    const auto files = group_files(version, attributes(inner));
    for (const auto& [name, text] : files) report.bytes += write_text(folder.path() / name, text);
    if (!inner.empty())
        for (const auto& [name, text] : group_files(version, "{}")) write_text(folder.path() / inner / name, text);
    const auto& [entry, text] = files.back();
    ForeignContent content;
    switch (foreign) {
        case Foreign::replaced:
            if (!fs::exists(target)) break;
            return {std::move(report), replaced_in_words(target, folder.commit_and_keep_old(entry))};
        case Foreign::excluded: content = desktop_files_in(target); break;
        case Foreign::kept: content = foreign_content(target, text); break;
        case Foreign::refused:  // checks again, since other programs may have written meanwhile
            expect_no_foreign_content(target);
            content = foreign_content(target);
            break;
    }
    if (!content.names.empty()) {
        std::string kept = kept_in_words(target, content, folder.commit_and_keep_old(entry));
        return {std::move(report), std::move(kept)};
    }
    carry_over(content, target, folder.path(), folder.inner());
    folder.commit(entry);
    return {std::move(report), {}};
}

/// Calls the options' `progress` at most every 100 ms. Throws if the options' `cancel` is set.
class ToldImport {
public:
    ToldImport(const fs::path& target, const VolumeInfo& info, const ImportOptions& options)
        : target_(target), voxels_(double(voxel_count(info))), options_(options)
    {}

    void operator()(double fraction)
    {
        if (options_.cancel != nullptr && *options_.cancel)
            throw ImportStopped(target_.string() + ": stopped; no file is left half written");
        const Clock::time_point now = Clock::now();
        if (!options_.progress || now - told_ < std::chrono::milliseconds(100) || !(fraction > 0.0)) return;
        told_ = now;
        const double seconds = std::chrono::duration<double>(now - begin_).count();
        options_.progress({.fraction = fraction,
                           .voxels_per_second = fraction * voxels_ / seconds,
                           .seconds_left = (1.0 - fraction) / fraction * seconds});
    }

private:
    const fs::path& target_;
    double voxels_;
    const ImportOptions& options_;
    Clock::time_point begin_ = Clock::now(), told_{};
};

}  // namespace

std::optional<std::vector<Size3>> stored_chunks(const VolumeSource& source)
{
    const Size3& size = source.info().size;
    const std::optional<StoredBlocks> stored = source.stored_blocks(0, MAX_STORED_BLOCKS);
    if (!stored || stored->fill != 0.0) return std::nullopt;
    const std::optional<std::vector<uint64_t>> keys =
        chunk_keys(*stored, size, {Size3(0), size}, 64 * MAX_STORED_BLOCKS);
    if (!keys) return std::nullopt;
    std::vector<Size3> chunks;
    for (const uint64_t key : *keys) chunks.push_back(uninterleaved(key));
    return chunks;
}

bool are_few(const std::vector<Size3>& chunks, const Size3& size)
{
    const Size3 counts = chunk_counts(size);
    return int64_t(chunks.size()) <= counts.x * counts.y * counts.z / MIN_GAIN;
}

namespace {

WrittenImage write_labels(const VolumeSource& labels, const fs::path& target, const std::vector<Size3>& chunks,
                          const ImportOptions& options, Foreign foreign)
{
    const VolumeInfo info = make_preparation(labels, {})->info();
    const int levels = level_count(info.size);
    ToldImport told(target, info, options);
    const auto attributes = [&](const std::string& folder) {
        return import_attributes(options.version.value_or(OmeZarrVersion::v0_4), target.filename().string(), info,
                                 levels, Halving::label, &*options.label_image, folder);
    };
    return write_image(labels, info, levels, target, chunks, options, attributes, std::ref(told), foreign);
}

}  // namespace

ImportReport write_label_image(const VolumeSource& labels, const fs::path& target, const std::vector<Size3>& chunks,
                               const ImportOptions& options)
{
    return write_labels(labels, target, chunks, options, Foreign::refused).report;
}

std::string save_label_image(const VolumeSource& labels, const fs::path& folder, const LabelImage& image,
                             const ImportOptions& options, Foreign foreign)
{
    const bool replaces_any = foreign == Foreign::replaced;
    const fs::path target = label_image_target(folder, replaces_any);
    const bool belongs = belongs_to_image(target);
    ImportOptions wanted = options;
    wanted.label_image = image;
    if (belongs) wanted.label_image->source = "../../";
    // An image of any version may be replaced, but labels must have the version of the image to which they belong.
    wanted.version = replaces_any && !belongs ? options.version.value_or(OmeZarrVersion::v0_4)
                                              : label_image_version(target, options.version);
    const std::optional<std::vector<Size3>> chunks = stored_chunks(labels);
    SHVR_CHECK(chunks, "the source does not know what it stores");
    std::string kept = write_labels(labels, target, *chunks, wanted, foreign).kept;
    if (belongs) list_label_image(target, *wanted.version);
    renew_consolidated_metadata(target);
    return kept;
}

std::string save_number_image(const VolumeSource& numbers, const fs::path& folder, const std::string& kind,
                              const Progress& progress, Foreign foreign)
{
    const fs::path target = number_image_target(folder, kind, foreign == Foreign::replaced);
    const std::optional<std::vector<Size3>> chunks = stored_chunks(numbers);
    SHVR_CHECK(chunks, "the source does not know what it stores");
    const VolumeInfo& info = numbers.info();
    const auto attributes = [&](const std::string& inner) {
        return number_attributes(target.filename().string(), info, kind, inner);
    };
    const ImportOptions options;
    std::string kept = write_image(numbers, info, 1, target, *chunks, options, attributes, progress, foreign).kept;
    renew_consolidated_metadata(target);
    return kept;
}

}  // namespace shvr

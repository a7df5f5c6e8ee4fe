#include "engine/projects/import_sparse.h"

#include <algorithm>
#include <span>

#include "engine/base/error.h"
#include "engine/formats/zarr/zarr_codec.h"
#include "engine/projects/import_cube.h"
#include "engine/projects/import_files.h"
#include "engine/projects/part_folder.h"
#include "engine/volume/voxel_dispatch.h"
#include "engine/volume/voxel_walk.h"

namespace shvr {
namespace {

/// With more than an eighth of all chunks stored, a dense import with all threads takes no longer than a sparse one.
constexpr int64_t MIN_GAIN = 8;

Size3 chunk_counts(const Size3& size)
{
    return (size + (IMPORT_CHUNK - 1)) / IMPORT_CHUNK;
}

/// The bits of x, y and z interleaved (Morton 1966): chunks below one of a coarser level are adjacent. Chunks of
/// MAX_SIDE voxels have 14 bits a side.
uint64_t interleaved(const Size3& chunk)
{
    uint64_t key = 0;
    for (int bit = 0; bit < 20; ++bit)
        for (int axis = 0; axis < 3; ++axis) key |= (uint64_t(chunk[axis]) >> bit & 1) << (3 * bit + axis);
    return key;
}

Size3 ancestor(const Size3& chunk, int levels)
{
    return {chunk.x >> levels, chunk.y >> levels, chunk.z >> levels};
}

/// Makes the non-empty chunks of a level and of all levels below: depth first, so that one chunk of each level is in
/// memory.
template <class T>
class Levels {
public:
    Levels(const VolumeSource& source, const VolumeInfo& info, const std::filesystem::path& folder,
           OmeZarrVersion version, const ZarrCompressor& compressor, const Progress& progress)
        : source_(source), info_(info), compressor_(compressor), progress_(progress), half_(IMPORT_CHUNK / 2)
    {
        written_.levels = level_count(info.size);
        for (int level = 0; level < written_.levels; ++level) {
            volumes_.push_back(import_level(folder, info, level, version, compressor, false));
            cubes_.emplace_back(IMPORT_CHUNK);
            const Size3 counts = chunk_counts(size_of_level(info.size, level));
            written_.chunks += counts.x * counts.y * counts.z;
            const std::string metadata = to_text(volumes_.back().metadata());
            const std::filesystem::path file = folder / std::to_string(level) / volumes_.back().metadata().key();
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
    /// The first chunks of `rest` that lie below the same chunk `levels` above.
    static std::span<const Size3> take_below(std::span<const Size3>& rest, int levels)
    {
        const Size3 above = ancestor(rest.front(), levels);
        const auto end = std::ranges::find_if(rest, [&](const Size3& each) { return ancestor(each, levels) != above; });
        const auto count = size_t(end - rest.begin());
        const std::span<const Size3> taken = rest.first(count);
        rest = rest.subspan(count);
        return taken;
    }

    /// `below`: the chunks of level 0 that lie below the chunk, at least one.
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
        halve_cube(fine, half_, Halving::label);
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
    std::vector<ZarrVolume> volumes_;  ///< used for names and places; nothing is read through them
    std::vector<ImportCube<T>> cubes_;
    ImportCube<T> half_;
    std::vector<T> voxels_;
    std::vector<std::byte> compressed_;
    SparseLevelFiles written_;
    int64_t done_ = 0;
    double all_ = 1.0;
};

}  // namespace

std::optional<std::vector<Size3>> sparse_chunks(const VolumeSource& source)
{
    const Size3& size = source.info().size;
    const Size3 counts = chunk_counts(size);
    const int64_t most = counts.x * counts.y * counts.z / MIN_GAIN;
    const std::optional<StoredBlocks> stored = source.stored_blocks(0, MAX_STORED_BLOCKS);
    if (!stored || stored->fill != 0.0) return std::nullopt;
    std::vector<Size3> chunks;
    for (const glm::ivec3& block : stored->blocks) {
        const VoxelBox box = box_of_block(*stored, block, size);
        const Size3 lower = box.lower / IMPORT_CHUNK, upper = chunk_counts(box.upper);
        for (int64_t z = lower.z; z < upper.z; ++z)
            for (int64_t y = lower.y; y < upper.y; ++y)
                for (int64_t x = lower.x; x < upper.x; ++x) {
                    if (!chunks.empty() && chunks.back() == Size3(x, y, z)) continue;
                    // Small blocks touch the same chunk again and again.
                    if (int64_t(chunks.size()) > 64 * MAX_STORED_BLOCKS) return std::nullopt;
                    chunks.emplace_back(x, y, z);
                }
    }
    std::ranges::sort(chunks, {}, interleaved);
    const auto repeated = std::ranges::unique(chunks);
    chunks.erase(repeated.begin(), repeated.end());
    if (int64_t(chunks.size()) > most) return std::nullopt;
    return chunks;
}

SparseLevelFiles write_sparse_levels(const VolumeSource& source, const VolumeInfo& info,
                                     const std::vector<Size3>& chunks, const std::filesystem::path& folder,
                                     OmeZarrVersion version, const ZarrCompressor& compressor, const Progress& progress)
{
    return with_voxel_type(info.type, [&]<class T>(T) {
        return Levels<T>(source, info, folder, version, compressor, progress).write(chunks);
    });
}

}  // namespace shvr

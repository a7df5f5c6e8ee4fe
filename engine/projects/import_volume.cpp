#include "engine/projects/import_volume.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <thread>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/readers.h"
#include "engine/formats/zarr/consolidated.h"
#include "engine/formats/zarr/project.h"
#include "engine/projects/foreign_content.h"
#include "engine/projects/import_box.h"
#include "engine/projects/import_chunks.h"
#include "engine/projects/import_files.h"
#include "engine/projects/import_pyramid.h"
#include "engine/projects/import_sparse.h"
#include "engine/projects/import_tally.h"
#include "engine/projects/part_folder.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Bytes = std::span<const std::byte>;

/// Rows of a slab of 64 slices held at once, twice: one batch is read while the previous one is compressed.
constexpr int64_t SLAB_BYTES = int64_t{64} << 20;
/// The state is written each time this multiple of its writing time has passed, so that it costs 5 %.
constexpr double STATE_INTERVAL = 20.0;

double seconds_since(Clock::time_point begin)
{
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

int thread_count(int wanted)
{
    return wanted > 0 ? wanted : std::max(1, int(std::thread::hardware_concurrency()));
}

/// Refuses processing that would create new label numbers.
void check_labels(const VolumeInfo& info, const PreparationOptions& preparation)
{
    if (info.type == VoxelType::float32 || info.type == VoxelType::float64)
        fail(info.name, ": its voxel type is ", name_of(info.type),
             "; expected an integer type, since labels are whole numbers");
    PreparationOptions harmless;
    harmless.crop = preparation.crop;
    if (preparation != harmless)
        fail(info.name, ": its labels cannot be ", to_text(preparation),
             "; expected no preparation but --crop, since there is no label between two labels");
}

class Import {
public:
    /// Progress of the pass that finds the range of voxels to be reversed.
    static Progress looking(const ImportOptions& options)
    {
        return [&options](double fraction) {
            if (options.cancel != nullptr && *options.cancel)
                throw ImportStopped("the import was stopped before anything was written");
            if (options.progress) options.progress({.fraction = fraction, .seconds_left = -1.0});
        };
    }

    /// Refuses sizes that would be too large; reads nothing.
    static void check_size(const VolumeSource& source, const fs::path& project, PreparationOptions preparation)
    {
        preparation.reverse = false;  // not measured here, since that would require a pass over all voxels
        static_cast<void>(checked(make_preparation(source, preparation)->info(), project));
    }

    Import(const VolumeSource& source, const fs::path& origin, const fs::path& project, const ImportOptions& options)
        : origin_(fs::absolute(origin).lexically_normal()),
          options_(options),
          preparation_(make_preparation(source, options.preparation, looking(options))),
          info_(checked(preparation_->info(), project)),
          identity_(options.label_image ? std::string() : import_identity(source, origin_, options)),
          folder_(project, options.overwrites),
          threads_(thread_count(options.threads)),
          pool_(
              threads_, [this] { poll(); }, [this] { stop_where_asked(); })
    {
        begin_anew();
        report_.was_resumed = resume(source.info().warnings);
    }

    const fs::path& folder() const { return folder_.path(); }
    void abandon() { folder_.abandon(); }

    ImportReport run()
    {
        const auto voxel_bytes = int64_t(bytes_of(info_.type));
        const int64_t rows = SLAB_BYTES / (IMPORT_CHUNK * info_.size.x * voxel_bytes) / IMPORT_CHUNK * IMPORT_CHUNK;
        rows_ = std::clamp(rows, std::min(IMPORT_CHUNK, info_.size.y), info_.size.y);
        const int64_t bands = (info_.size.y + rows_ - 1) / rows_;
        const int64_t slabs = (info_.size.z + IMPORT_CHUNK - 1) / IMPORT_CHUNK;
        chunks_of_plane_ = counts(0).x * counts(0).y;
        chunks_done_ = slabs_done_ * chunks_of_plane_;
        chunks_at_start_ = chunks_done_;
        write_level_metadata();
        begin_ = Clock::now();

        const auto slab_of = [&](int64_t step) {
            const int64_t z = step / bands * IMPORT_CHUNK;
            const int64_t y = step % bands * rows_;
            return Preparation::Slab{z, std::min(info_.size.z, z + IMPORT_CHUNK), y, std::min(info_.size.y, y + rows_)};
        };
        const int64_t first = slabs_done_ * bands;
        for (int64_t step = first; step < slabs * bands; ++step) {
            const auto place = size_t(step % 2);
            if (step == first) read(slab_of(step), place);
            const auto batch = start(slab_of(step), place);
            if (step + 1 < slabs * bands) read(slab_of(step + 1), 1 - place);
            pool_.wait(batch);
            if (step % bands == bands - 1) finish_slab(step / bands, slabs);
        }
        finish_levels();
        pack_shards();
        write_attributes();
        if (!options_.label_image) write_knowledge();
        finish_folder();
        return report_;
    }

private:
    /// Checks before anything is allocated or read.
    static const VolumeInfo& checked(const VolumeInfo& info, const fs::path& project)
    {
        static_cast<void>(voxel_count(info));
        try {
            check_tables(project, info);
        } catch (const Error& error) {
            fail(project.string(), ": would have ", info.size.x, " x ", info.size.y, " x ", info.size.z,
                 " voxels, and a project keeps the range of every brick and the checksum of every chunk, also where ",
                 "nothing is stored (", error.what(), "): use --crop or --downscale");
        }
        return info;
    }

    // ---- One slab ----

    void read(const Preparation::Slab& slab, size_t place)
    {
        const int64_t voxels = info_.size.x * (slab.upper_row - slab.lower_row) * (slab.upper - slab.lower);
        buffers_[place].resize(size_t(voxels) * bytes_of(info_.type));
        preparation_->read(slab, buffers_[place], pool_);
    }

    /// Starts writing chunks and levels, and hashing and counting slices.
    std::shared_ptr<WorkPool::Batch> start(const Preparation::Slab& slab, size_t place)
    {
        const std::byte* const voxels = buffers_[place].data();
        const size_t row_bytes = size_t(info_.size.x) * bytes_of(info_.type);
        const size_t slice_bytes = row_bytes * size_t(slab.upper_row - slab.lower_row);
        const int64_t along_x = counts(0).x;
        const int64_t along_y = (slab.upper_row - slab.lower_row + IMPORT_CHUNK - 1) / IMPORT_CHUNK;
        const int64_t chunks = along_x * along_y;
        const auto run = [=, this](int64_t task, int worker) {
            if (task >= chunks) {
                const auto slice = size_t(task - chunks);
                tally_->add(slab.lower + task - chunks, Bytes(voxels + slice * slice_bytes, slice_bytes), worker);
                return;
            }
            const Size3 chunk{task % along_x, slab.lower_row / IMPORT_CHUNK + task / along_x,
                              slab.lower / IMPORT_CHUNK};
            const Size3 origin = chunk * IMPORT_CHUNK;
            const size_t first =
                size_t(origin.y - slab.lower_row) * row_bytes + size_t(origin.x) * bytes_of(info_.type);
            const ImportPyramid::Chunk taken{.origin = origin,
                                             .extent = glm::min(Size3(IMPORT_CHUNK), info_.size - origin),
                                             .voxels = voxels + first,
                                             .row_bytes = row_bytes,
                                             .slice_bytes = slice_bytes};
            chunks_->write(0, chunk, pyramid_->add(taken, worker), worker);
            ++chunks_done_;
        };
        return pool_.start(chunks + slab.upper - slab.lower, run);
    }

    void finish_slab(int64_t slab, int64_t slabs)
    {
        const int64_t slices = std::min(info_.size.z, (slab + 1) * IMPORT_CHUNK);
        tally_->finish(slab * IMPORT_CHUNK, slices);
        for (int level = 1; level < pyramid_->levels(); ++level) {
            if (!pyramid_->completes_layer(level, slices)) continue;
            write_layer(level, (size_of_level(Size3(slices), level).z - 1) / IMPORT_CHUNK);
            pyramid_->clear_layer(level);
        }
        slabs_done_ = slab + 1;
        if (slabs_done_ == slabs || options_.label_image ||
            seconds_since(state_written_) < STATE_INTERVAL * state_seconds_)
            return;
        const Clock::time_point begin = Clock::now();
        folder_.sync();
        write_state();
        state_written_ = Clock::now();
        state_seconds_ = seconds_since(begin);
    }

    void write_layer(int level, int64_t layer)
    {
        const Size3 chunks = counts(level);
        pool_.run(chunks.x * chunks.y, [&](int64_t task, int worker) {
            const Size3 chunk{task % chunks.x, task / chunks.x, layer};
            chunks_->write(level, chunk, pyramid_->gather(level, chunk, worker), worker);
        });
    }

    // ---- State kept between runs ----

    void begin_anew()
    {
        pyramid_ = make_import_pyramid(info_.size, info_.type, threads_, options_.halving);
        chunks_ = std::make_unique<ImportChunks>(folder_.path(), info_, pyramid_->levels(), version(),
                                                 options_.compressor, options_.has_shards, threads_);
        tally_ = std::make_unique<ImportTally>(info_, IMPORT_CHUNK, threads_);
        slabs_done_ = 0;
    }

    /// Written last: everything that it refers to is already on disk.
    void write_state()
    {
        StateWriter state;
        state.put(identity_);
        state.put_all(std::vector<int64_t>{slabs_done_});
        tally_->save(state);
        chunks_->save(state);
        pyramid_->save(state);
        state.write(folder_.state());
    }

    /// Resumes from a saved state; false if there was none. Clears a damaged state, or one of another import.
    bool resume(const std::vector<std::string>& warnings)
    {
        report_.warnings = warnings;
        std::error_code ignored;
        const bool is_begun = fs::exists(folder_.state(), ignored);
        // Labels come from sources whose changes are not reflected in any file.
        if (is_begun && !options_.label_image) {
            folder_.clear_temporary();
            try {
                StateReader state(folder_.state());
                if (state.take_text() == identity_) {
                    load_state(state);
                    return slabs_done_ > 0;
                }
                report_.warnings.push_back(
                    sentence(folder_.path().string(),
                             " was started from another file or with other options; the import starts over"));
            } catch (const Error& error) {
                report_.warnings.push_back(sentence(error.what(), "; the import starts over"));
            }
            begin_anew();
        }
        folder_.clear();
        write_state();
        return false;
    }

    void load_state(StateReader& state)
    {
        std::vector<int64_t> slabs(1);
        state.take_all(slabs);
        tally_->load(state);
        chunks_->load(state);
        pyramid_->load(state);
        slabs_done_ = slabs[0];
    }

    // ---- The rest of the folder ----

    void write_level_metadata()
    {
        for (int level = 0; level < pyramid_->levels(); ++level) {
            write_text(sentence(level, "/", chunks_->metadata(level).key()), to_text(chunks_->metadata(level)));
        }
    }

    void finish_levels()
    {
        pyramid_->finish();
        for (int level = IMPORT_REACH; level < pyramid_->levels(); ++level) {
            for (int64_t layer = 0; layer < counts(level).z; ++layer) write_layer(level, layer);
        }
    }

    /// Chunks have separate files until all are written: a shard spans many slabs, and is not changed once written.
    void pack_shards()
    {
        for (int level = 0; level < pyramid_->levels(); ++level)
            pool_.run(chunks_->shards(level), [&](int64_t shard, int) { chunks_->pack(level, shard); });
        chunks_->remove_loose();
    }

    void write_attributes()
    {
        const LabelImage* labels = options_.label_image ? &*options_.label_image : nullptr;
        const std::string attributes =
            import_attributes(version(), folder_.name(), info_, pyramid_->levels(), options_.halving, labels);
        for (const auto& [name, text] : group_files(version(), attributes)) write_text(name, text);
    }

    void write_knowledge()
    {
        for (int level = 0; level < pyramid_->levels(); ++level) {
            write(ranges_path({}, level), to_bytes({.kind = "ranges",
                                                    .level = level,
                                                    .element_bytes = 2 * bytes_of(info_.type),
                                                    .counts = size_of_level(size_of_level(info_.size, level), 5),
                                                    .elements = pyramid_->ranges(level)}));
            const Bytes checksums = std::as_bytes(std::span(chunks_->checksums(level)));
            write(checksums_path({}, level), to_bytes({.kind = "checksum",
                                                       .level = level,
                                                       .element_bytes = sizeof(uint64_t),
                                                       .counts = counts(level),
                                                       .elements = {checksums.begin(), checksums.end()}}));
        }
        ProjectRecord record{.info = info_, .levels = pyramid_->levels()};
        // Types with too many values to count each are measured in the written project, without the source.
        const std::optional<VolumeStatistics> counted = tally_->statistics();
        record.statistics = counted ? *counted
                                    : measure(*open_ome_zarr(folder_.path(), {}),
                                              {.exact = true, .progress = [this](double) { stop_where_asked(); }});
        record.content_hash = tally_->content_hash();
        record.source = origin_.string();
        record.preparation = to_text(options_.preparation);
        write_text(PROJECT_RECORD, to_text(record));
        write_text(PROJECT_SESSION, import_session());
    }

    void finish_folder()
    {
        report_.info = info_;
        report_.levels = pyramid_->levels();
        report_.bricks = chunks_->all();
        report_.bricks_stored = chunks_->stored();
        report_.bytes = chunks_->bytes() + other_bytes_;
        if (options_.label_image) expect_no_foreign_content(origin_);  // checked again: the work took a while
        folder_.finish();
        report_.project = folder_.path();
    }

    void write(const fs::path& file, Bytes content)
    {
        write_part_file(folder_.path() / file, content);
        other_bytes_ += int64_t(content.size());
    }
    void write_text(const fs::path& file, const std::string& text) { write(file, std::as_bytes(std::span(text))); }

    // ---- While workers are busy ----

    void stop_where_asked() const
    {
        if (options_.cancel != nullptr && *options_.cancel) throw ImportStopped("stopped");
    }
    void poll()
    {
        stop_where_asked();
        if (!options_.progress || seconds_since(told_) < 0.1) return;
        told_ = Clock::now();
        const auto all = double(chunks_of_plane_ * counts(0).z);
        const auto done = double(chunks_done_ - chunks_at_start_);
        const auto left = all - double(chunks_done_);
        const double seconds = seconds_since(begin_);
        if (!(all > 0.0) || !(done > 0.0)) return;
        const auto voxels = double(voxel_count(info_));
        options_.progress({.fraction = double(chunks_done_) / all,
                           .voxels_per_second = done / all * voxels / seconds,
                           .seconds_left = left / done * seconds});
    }

    Size3 counts(int level) const { return chunks_->counts(level); }
    OmeZarrVersion version() const { return options_.version.value_or(OmeZarrVersion::v0_4); }

    fs::path origin_;
    const ImportOptions& options_;
    std::unique_ptr<Preparation> preparation_;
    VolumeInfo info_;
    std::string identity_;
    PartFolder folder_;  ///< declared last: if any member above fails to be created, no folder is made
    int threads_;
    ImportReport report_;

    std::unique_ptr<ImportPyramid> pyramid_;
    std::unique_ptr<ImportChunks> chunks_;
    std::unique_ptr<ImportTally> tally_;
    int64_t slabs_done_ = 0;
    int64_t other_bytes_ = 0;  ///< of files other than chunks
    int64_t rows_ = 0;         ///< rows of a slab held at once
    std::array<std::vector<std::byte>, 2> buffers_;

    int64_t chunks_of_plane_ = 0;
    int64_t chunks_at_start_ = 0;
    std::atomic<int64_t> chunks_done_ = 0;
    Clock::time_point begin_{}, told_{}, state_written_{};
    double state_seconds_ = 0.0;

    WorkPool pool_;  ///< last: its tasks use all members above
};

/// Where unfinished work could not be removed, a sentence about it; otherwise empty.
std::string remains_of(const fs::path& part)
{
    std::error_code error;
    if (part.extension() != ".part" || !fs::exists(fs::symlink_status(part, error))) return {};
    return sentence("; ", part.string(), " could not be removed: the same command replaces it, rm -r removes it");
}

/// Exports a label image, completely or not at all.
ImportReport import_all(const VolumeSource& labels, const fs::path& target, const ImportOptions& options)
{
    Import job(labels, target, target, options);
    try {
        return job.run();
    } catch (const ImportStopped&) {
        job.abandon();
        throw ImportStopped(target.string() + ": stopped; no file is left half written" + remains_of(job.folder()));
    } catch (const Error& error) {
        job.abandon();
        const std::string remains = remains_of(job.folder());
        if (remains.empty()) throw;
        fail(error.what(), remains);
    } catch (...) {
        job.abandon();
        throw;
    }
}

}  // namespace

ImportReport import_volume(const VolumeSource& source, const fs::path& origin, const fs::path& project,
                           const ImportOptions& options)
{
    if (options.halving == Halving::label) check_labels(source.info(), options.preparation);
    Import::check_size(source, project, options.preparation);
    Import job(source, origin, project, options);
    constexpr const char* GOES_ON = ", and the same command goes on from there; rm -r removes it";
    const fs::path part = job.folder();
    try {
        return job.run();
    } catch (const ImportStopped&) {
        throw ImportStopped(sentence(job.folder().string(), ": the import was stopped; what is done is kept", GOES_ON));
    } catch (const Error& error) {
        fail(error.what(), "; what is done is kept in ", part.string(), GOES_ON);
    }
}

bool is_label_image(const fs::path& path)
{
    const fs::path plain = path.has_filename() ? path : path.parent_path();
    const std::string form = lower_case(plain.extension().string());
    return form == ".zarr" || (form.empty() && plain.parent_path().filename() == "labels");
}

ImportReport export_label_image(const VolumeSource& labels, const fs::path& folder, const LabelImage& image,
                                const ImportOptions& options)
{
    check_labels(labels.info(), {});
    const fs::path target = label_image_target(folder);
    expect_no_foreign_content(target);
    LabelImage described = image;
    const bool belongs = belongs_to_image(target);
    if (belongs) described.source = "../../";
    const OmeZarrVersion version = label_image_version(target, options.version);
    ImportOptions wanted{.halving = Halving::label,
                         .overwrites = true,
                         .label_image = described,
                         .threads = options.threads,
                         .compressor = options.compressor,
                         .version = version,
                         .progress = options.progress,
                         .cancel = options.cancel};
    const std::optional<std::vector<Size3>> chunks = stored_chunks(labels);
    const bool is_sparse = chunks && are_few(*chunks, labels.info().size);
    const ImportReport report =
        is_sparse ? write_label_image(labels, target, *chunks, wanted) : import_all(labels, target, wanted);
    if (belongs) list_label_image(target, version);
    renew_consolidated_metadata(target);
    return report;
}

}  // namespace shvr

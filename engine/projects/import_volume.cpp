#include "engine/projects/import_volume.h"

#include <algorithm>
#include <chrono>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "engine/base/text.h"
#include "engine/base/waits/unfinished_work.h"
#include "engine/formats/readers.h"
#include "engine/formats/zarr/consolidated.h"
#include "engine/formats/zarr/project.h"
#include "engine/projects/foreign_content.h"
#include "engine/projects/import_box.h"
#include "engine/projects/import_chunks.h"
#include "engine/projects/import_files.h"
#include "engine/projects/import_pass.h"
#include "engine/projects/import_piece.h"
#include "engine/projects/import_plan.h"
#include "engine/projects/import_sparse.h"
#include "engine/projects/part_folder.h"
#include "engine/remote/address.h"
#include "engine/volume/voxel_numbers.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Bytes = std::span<const std::byte>;

/// Interval between saves of the state, in durations of a save: saving takes 5 % of the time.
constexpr double STATE_INTERVAL = 20.0;

double seconds_since(Clock::time_point begin)
{
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Refuses processing that would turn labels into other numbers.
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

/// What becomes of NAME.part, for the message that an import or export was stopped.
const char* use_of_part(const ImportOptions& options)
{
    return options.label_image       ? "the same command replaces it, rm -r removes it"
           : options.gaps == nullptr ? "the same import goes on from there; rm -r removes it"
                                     : "it is of no further use; rm -r removes it";
}

/// For a signal that ends the program while the folder cannot be removed.
std::string remains_in_words(const fs::path& part, const ImportOptions& options, bool is_piece, bool joins)
{
    if (is_piece) return sentence(part.string(), " keeps what the task has done: the same task goes on from there");
    if (joins) return sentence(part.string(), " is left: the same command replaces it, rm -r removes it");
    return sentence(part.string(),
                    options.label_image ? " is left: " : " keeps what the import has done: ", use_of_part(options));
}

class Import {
public:
    /// Returns a callback for the progress of finding the range of values, which a reversal needs.
    static Progress looking(const ImportOptions& options)
    {
        return [&options](double fraction) {
            if (options.cancel != nullptr && *options.cancel)
                throw ImportStopped("the import was stopped before anything was written");
            if (options.progress) options.progress({.fraction = fraction, .seconds_left = -1.0});
        };
    }

    /// `task`: for one of several processes, whose piece is `project`.
    Import(const VolumeSource& source, const fs::path& origin, const fs::path& project, const ImportOptions& options,
           const ImportPlan& plan, const std::optional<TaskChoice>& task = {}, bool joins = false)
        : source_(source),
          origin_(whole_path(origin)),
          options_(options),
          plan_(plan),
          preparation_(make_preparation(source, options.preparation, looking(options))),
          info_(preparation_->info()),
          identity_(options.label_image ? std::string()
                                        : import_identity(source, origin_, options,
                                                          plan.stored ? "stored chunks" : "all voxels", joins || task)),
          task_(task),
          joins_(joins),
          folder_(project, options.overwrites && !task),
          unfinished_(std::in_place, remains_in_words(folder_.path(), options, task.has_value(), joins)),
          threads_(import_threads(options.threads)),
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
        write_level_metadata();
        begin_ = Clock::now();
        done_at_start_ = pass_->done();
        run_pass();
        return finished();
    }

    /// Leaves the piece of the task.
    void make_piece()
    {
        begin_ = Clock::now();
        done_at_start_ = pass_->done();
        StateWriter state;
        state.put(identity_);
        if (!plan_.stored) {
            run_pass();
            pass_->save_piece(state);
            chunks_->save(state);
        }
        state.write(folder_.path() / PIECE_STATE);
        folder_.finish();
        unfinished_.reset();
    }

    ImportReport join(const std::vector<fs::path>& pieces)
    {
        write_level_metadata();
        begin_ = Clock::now();
        for (const fs::path& piece : pieces) {
            stop_where_asked();
            StateReader state(piece / PIECE_STATE);
            if (state.take_text() != identity_)
                fail(piece.string(),
                     ": was imported from another file or with other options; expected the same in all "
                     "tasks: remove it, and run its task again");
            pass_->merge_piece(state);
            chunks_->merge(state, chunks_in(piece));
        }
        pass_->finish_pieces();
        return finished();
    }

private:
    static constexpr const char* PIECE_STATE = "piece.state";

    void run_pass()
    {
        pass_->run({.is_due = [this] { return is_state_due(); }, .keep = [this] { keep_state(); }});
    }

    ImportReport finished()
    {
        chunks_->finish();
        pack_shards();
        write_attributes();
        if (!options_.label_image) write_knowledge();
        finish_folder();
        return report_;
    }

    ImportChunks chunks_in(const fs::path& folder) const
    {
        return ImportChunks(folder, info_, level_count(info_.size), version(), options_.compressor, options_.has_shards,
                            threads_ + 1, plan_.fill);
    }

    // ---- State kept between runs ----

    void begin_anew()
    {
        pass_.reset();
        chunks_ = std::make_unique<ImportChunks>(folder_.path(), info_, level_count(info_.size), version(),
                                                 options_.compressor, options_.has_shards, threads_ + 1, plan_.fill);
        const ImportSetup setup{.info = info_,
                                .halving = options_.halving,
                                .fill = plan_.fill,
                                .threads = threads_,
                                .chunks = *chunks_,
                                .pool = pool_,
                                .slabs = task_ ? std::optional(slabs_of(*task_, info_.size)) : std::nullopt};
        const Size3 first = options_.preparation.crop ? options_.preparation.crop->lower : Size3(0);
        pass_ = plan_.stored ? make_sparse_pass(source_, first, *plan_.stored, setup)
                             : make_dense_pass(*preparation_, setup);
    }

    /// Label images are never resumed, since no file would show that their source has changed in between.
    bool is_resumable() const
    {
        const bool may_change = task_ && leads_to_network(origin_);
        return !options_.label_image && options_.gaps == nullptr && !joins_ && !may_change;
    }
    bool is_state_due() const
    {
        return is_resumable() && seconds_since(state_written_) >= STATE_INTERVAL * state_seconds_;
    }
    void keep_state()
    {
        const Clock::time_point begin = Clock::now();
        folder_.sync();
        write_state();
        state_written_ = Clock::now();
        state_seconds_ = seconds_since(begin);
    }

    /// Writes the state after everything to which it refers is on the disk.
    void write_state()
    {
        StateWriter state;
        state.put(joins_ ? "joining " + identity_ : identity_);
        pass_->save(state);
        chunks_->save(state);
        state.write(folder_.state());
    }

    /// Resumes from a saved state; returns false if there is none. Deletes a state that is damaged or another import's.
    bool resume(const std::vector<std::string>& warnings)
    {
        report_.warnings = warnings;
        std::error_code ignored;
        const bool is_begun = fs::exists(folder_.state(), ignored);
        if (is_begun && is_resumable()) {
            folder_.clear_temporary();
            try {
                StateReader state(folder_.state());
                if (state.take_text() == identity_) {
                    pass_->load(state);
                    chunks_->load(state);
                    return pass_->is_begun();
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

    // ---- The rest of the folder ----

    void write_level_metadata()
    {
        for (int level = 0; level < chunks_->levels(); ++level) {
            write_text(sentence(level, "/", chunks_->metadata(level).key()), to_text(chunks_->metadata(level)));
        }
    }

    /// Packs the separate chunk files into shards, at the end: a shard spans many slabs, and is written only once.
    void pack_shards()
    {
        for (int level = 0; level < chunks_->levels(); ++level) {
            const std::vector<int64_t> shards = chunks_->shards(level);
            pool_.run(int64_t(shards.size()), [&](int64_t task, int) { chunks_->pack(level, shards[size_t(task)]); });
        }
        chunks_->remove_loose();
    }

    void write_attributes()
    {
        const LabelImage* labels = options_.label_image ? &*options_.label_image : nullptr;
        const std::string attributes =
            import_attributes(version(), folder_.name(), info_, chunks_->levels(), options_.halving, labels);
        for (const auto& [name, text] : group_files(version(), attributes)) write_text(name, text);
    }

    void write_knowledge()
    {
        for (int level = 0; level < chunks_->levels(); ++level) {
            write(ranges_path({}, level), to_bytes(pass_->ranges(level)));
            write(checksums_path({}, level), to_bytes(checksums(level)));
        }
        note_gaps();
        ProjectRecord record{.info = info_, .levels = chunks_->levels()};
        // If a type has too many values to count each, the written project is measured instead of the source.
        const std::optional<VolumeStatistics> counted = pass_->statistics();
        record.statistics = counted ? *counted
                                    : measure(*open_ome_zarr(folder_.path(), {}),
                                              {.exact = true, .progress = [this](double) { stop_where_asked(); }});
        record.content_hash = pass_->content_hash();
        record.source = origin_.string();
        record.preparation = to_text(options_.preparation);
        load_voxels(info_.type, plan_.fill.data(), std::span(&record.fill, 1));
        write_text(PROJECT_RECORD, to_text(record));
        write_text(PROJECT_SESSION, import_session());
    }

    void note_gaps()
    {
        if (options_.gaps == nullptr || options_.gaps->empty()) return;
        report_.voxels_not_read = options_.gaps->voxels();
        info_.warnings.push_back(sentence(options_.gaps->in_words(), " and have ",
                                          is_float(info_.type) ? "no value" : "the lowest value of their type"));
        report_.warnings.push_back(info_.warnings.back());
    }

    ProjectTable checksums(int level) const
    {
        const Size3 counts = size_of_level(size_of_level(info_.size, level), IMPORT_REACH);
        ProjectTable table{.kind = "checksum", .level = level, .element_bytes = sizeof(uint64_t), .counts = counts};
        table.is_sparse = true;
        table.elements.resize(sizeof(uint64_t));
        for (const StoredChunk& chunk : chunks_->written(level)) {
            table.keys.push_back(chunk.index);
            const auto bytes = std::as_bytes(std::span(&chunk.checksum, 1));
            table.elements.insert(table.elements.end(), bytes.begin(), bytes.end());
        }
        return stored_form(std::move(table), has_small_tables(info_));
    }

    void finish_folder()
    {
        report_.info = info_;
        report_.levels = chunks_->levels();
        report_.bricks = chunks_->all();
        report_.bricks_stored = chunks_->stored();
        report_.bytes = chunks_->bytes() + other_bytes_;
        if (options_.label_image) expect_no_foreign_content(origin_);  // checks again, after a long export
        folder_.finish();
        unfinished_.reset();
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
        const auto all = double(pass_->all()), all_done = double(pass_->done());
        const double done = all_done - double(done_at_start_);
        const double seconds = seconds_since(begin_);
        if (!(all > 0.0) || !(done > 0.0)) return;
        try {
            options_.progress({.fraction = all_done / all,
                               .voxels_per_second = done / all * pass_->voxels() / seconds,
                               .seconds_left = (all - all_done) / done * seconds});
        } catch (const Stopped&) {  // cancelled after the check above
            throw ImportStopped("stopped");
        }
    }

    OmeZarrVersion version() const { return options_.version.value_or(OmeZarrVersion::v0_4); }

    const VolumeSource& source_;
    fs::path origin_;
    const ImportOptions& options_;
    const ImportPlan& plan_;
    std::unique_ptr<Preparation> preparation_;
    VolumeInfo info_;
    std::string identity_;
    std::optional<TaskChoice> task_;
    bool joins_;         ///< makes the project from pieces
    PartFolder folder_;  ///< declared last, so that no folder is made if constructing another member fails
    std::optional<UnfinishedWork> unfinished_;
    int threads_;
    ImportReport report_;

    std::unique_ptr<ImportChunks> chunks_;
    std::unique_ptr<ImportPass> pass_;
    int64_t other_bytes_ = 0;  ///< total size of files other than chunks
    int64_t done_at_start_ = 0;
    Clock::time_point begin_{}, told_{}, state_written_{};
    double state_seconds_ = 0.0;

    WorkPool pool_;  ///< declared last, so that tasks end before other members are destroyed
};

/// Returns a message if unfinished work could not be removed; otherwise an empty text.
std::string remains_of(const fs::path& part)
{
    std::error_code error;
    if (part.extension() != ".part" || !fs::exists(fs::symlink_status(part, error))) return {};
    return sentence("; ", part.string(), " could not be removed: the same command replaces it, rm -r removes it");
}

/// What becomes of the remains of an import that was stopped or has failed, for its message.
std::string use_of_remains(const ImportOptions& options, bool is_resumed)
{
    if (!options.tells_commands)
        return is_resumed ? ", and can be resumed or deleted" : ", and is of no further use: delete it";
    return is_resumed ? ", and the same command goes on from there; rm -r removes it"
                      : ", and is of no further use; rm -r removes it";
}

/// Exports a label image; after a failure, removes all that was written.
ImportReport import_all(const VolumeSource& labels, const fs::path& target, const ImportOptions& options)
{
    const ImportPlan plan;
    check_all_tables(target, labels.info());
    Import job(labels, target, target, options, plan);
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
    const ImportPlan plan = plan_import(source, project, options);
    Import job(source, origin, project, options, plan);
    const std::string goes_on = use_of_remains(options, options.gaps == nullptr && !leads_to_network(origin));
    const std::string part = job.folder().string();
    try {
        return job.run();
    } catch (const ImportStopped&) {
        throw ImportStopped((options.tells_commands ? part + ": the import was stopped; what is done is kept"
                                                    : "what is done is kept in " + part) +
                            goes_on);
    } catch (const Error& error) {
        fail(error.what(), "; what is done is kept in ", part, goes_on);
    }
}

void import_piece(const VolumeSource& source, const fs::path& origin, const fs::path& piece,
                  const ImportOptions& options, const TaskChoice& task)
{
    SHVR_CHECK(options.gaps == nullptr && !options.label_image);
    if (options.halving == Halving::label) check_labels(source.info(), options.preparation);
    const ImportPlan plan = plan_import(source, piece, options);
    Import job(source, origin, piece, options, plan, task);
    const fs::path part = job.folder();
    const char* const goes_on = leads_to_network(origin) ? "the same task begins again"
                                                         : "what is done is kept, and the same task goes on from there";
    try {
        job.make_piece();
    } catch (const ImportStopped&) {
        throw ImportStopped(sentence(part.string(), ": the task was stopped; ", goes_on));
    } catch (const Error& error) {
        fail(error.what(), "; ", part.string(), ": ", goes_on);
    }
}

ImportReport join_import(const VolumeSource& source, const fs::path& origin, const fs::path& project,
                         const ImportOptions& options, const std::vector<fs::path>& pieces)
{
    const ImportPlan plan = plan_import(source, project, options);
    if (plan.stored) return import_volume(source, origin, project, options);
    Import job(source, origin, project, options, plan, {}, true);
    try {
        return job.join(pieces);
    } catch (const ImportStopped&) {
        job.abandon();
        throw ImportStopped(sentence(project.string(), ": joining was stopped; the pieces are as they were"));
    } catch (...) {
        job.abandon();
        throw;
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

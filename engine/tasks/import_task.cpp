#include "engine/tasks/import_task.h"

#include <chrono>
#include <iomanip>
#include <utility>

#include "engine/annotation/files/stated_content.h"
#include "engine/annotation/writers/hold.h"
#include "engine/base/text.h"
#include "engine/projects/import_piece.h"
#include "engine/projects/part_folder.h"
#include "engine/remote/address.h"
#include "engine/tasks/import_estimate.h"
#include "engine/tasks/task_parts.h"
#include "engine/volume/grid.h"
#include "engine/volume/unit.h"

namespace shvr {

namespace {

constexpr int64_t MAX_BUDGET_MIB = int64_t{1} << 24;

void crop_fields(Fields& f, VoxelBox& crop)
{
    const auto corner = [&](const char* name, Size3& voxel, const About& about) {
        std::vector<int64_t> numbers{voxel.x, voxel.y, voxel.z};
        f.wholes(name, numbers, 0, MAX_SIDE, about);
        voxel = {numbers[0], numbers[1], numbers[2]};
    };
    corner("lower", crop.lower, {"first voxel of the box", "voxels"});
    corner("upper", crop.upper, {"the one after its last", "voxels"});
    f.check("", glm::all(glm::lessThan(crop.lower, crop.upper)), "a lower corner that is below the upper one");
}

/// Warns if the volume looks like annotation of a scan. Uses the project's statistics, so that no voxel is read again.
void warn_of_labels(const ImportTask& task, const Gaps& gaps, ImportReport& report)
{
    if (task.labels || !gaps.empty() || stated_content(task.volume)) return;  // a reader warns of what is stated
    const std::unique_ptr<VolumeSource> project = open_volume(report.project);
    const std::optional<VolumeStatistics> statistics = project->statistics();
    const std::string labels = statistics ? labels_in_words(*project, *statistics) : std::string();
    if (labels.empty()) return;
    report.warnings.push_back(
        sentence(task.volume.string(), ": looks like a label image, not like a scan: ", labels,
                 "; to load it as annotation, open its scan in the window, then File, Load annotation; to keep it as a "
                 "volume of labels, import it with ",
                 option_name(task.names, "labels")));
}

/// Reports progress as one stage, or as two if voxels are reversed: reversal needs a first pass to find their range.
class ImportListener {
public:
    ImportListener(const ImportTask& task, VoxelType type, ProgressReporter& reporter)
        : volume_(task.volume.string()), type_(type), reporter_(reporter), is_importing_(!task.reverse)
    {
        progress_ = reporter.begin((is_importing_ ? "importing " : "measuring ") + volume_);
    }

    void take(const ImportProgress& told)
    {
        if (told.voxels_per_second == 0.0) return progress_(told.fraction);  // nothing to keep has been written yet
        try {
            if (!std::exchange(is_importing_, true)) progress_ = reporter_.begin("importing " + volume_);
            const double rate = told.voxels_per_second * double(bytes_of(type_)) / 1e6;
            reporter_.show(told.fraction, sentence(std::fixed, std::setprecision(rate < 10.0 ? 1 : 0), rate, " MB/s"),
                           told.seconds_left);
        } catch (const Stopped&) {
            // Ignores `Stopped` here: the import itself checks for cancellation, and keeps finished chunks.
        }
    }

private:
    std::string volume_;
    VoxelType type_;
    ProgressReporter& reporter_;
    Progress progress_;
    bool is_importing_;
};

}  // namespace

void fields(Fields& f, ImportTask& task)
{
    f.path("volume", task.volume,
           {.meaning = "the volume's file, folder or address",
            .allowed = PATH_OR_ADDRESS,
            .standard = "required",
            .is_required = true});
    f.path("project", task.project,
           {.meaning = "the folder to make, an OME-Zarr image", .standard = "required", .is_required = true});
    if (const About about{.meaning = "a box is taken out of the volume", .standard = "none"};
        f.has("crop", task.crop.has_value())) {
        VoxelBox crop = task.crop.value_or(VoxelBox{Size3(0), Size3(1)});
        f.section(
            "crop", [&](Fields& box) { crop_fields(box, crop); }, about);
        task.crop = crop;
    } else {
        f.mention("crop", about);
    }
    f.flag("reverse", task.reverse,
           {"dark and bright are swapped: the whole volume's smallest plus largest value, minus the voxel"});
    f.vector("blur", task.blur_voxels, {0.0, MAX_SIGMA}, {"sigma of a Gaussian blur, along x, y and z", "voxels"});
    f.whole("downscale", task.downscale, 1, MAX_DOWNSCALE, {"how many times smaller, along every axis"});
    f.flag("labels", task.labels,
           {"the voxels are labels: coarser levels hold the most frequent one instead of a mean"});
    f.text("raw", task.raw,
           {.meaning = "how a file of bare voxels is laid out: WxHxD:TYPE[:big|little][:OFFSET]", .standard = "none"});
    f.vector("spacing", task.choice.spacing, above_zero(MIN_SPACING, MAX_SPACING),
             {.meaning = "size of a voxel, for a file that states none, or instead of what it states",
              .allowed = "physical units per voxel, above 0",
              .standard = "the file's"});
    f.text("unit", task.choice.unit, {.meaning = "of that size, as in um", .standard = "the file's"});
    f.check("unit", !has_controls(task.choice.unit), "the name of a unit");
    f.text("channel", task.choice.channel,
           {.meaning = "what to take from a file with channels: its name or number", .standard = "none"});
    f.whole("level", task.choice.level, 0, 23, {"which size to take from a file with several: 0 the finest"});
    f.text("frame", task.choice.frame,
           {.meaning = "which time point to take from a file with several: its number", .standard = "none"});
    version_field(f, task.version, "version of OME-Zarr; automatic: 0.4");
    f.flag("shards", task.shards,
           {"of version 0.5: up to 512 chunks in a file, for storage that dislikes many small files"});
    f.flag("overwrite", task.overwrite,
           {"a project that is there is replaced, with all annotations in it, once the new one is complete"});
    incomplete_field(f, task.allows_incomplete,
                     "voxels that cannot be read are as low as their type allows, and the project states how many");
    threads_field(f, task.threads);
    f.whole("budget_host_mib", task.budget_host_mib, 0, MAX_BUDGET_MIB,
            {"memory that it may take, in MiB; 0: three quarters of what the process was given"});
}

void refuse_own_source(const ImportTask& task)
{
    std::error_code error;
    std::filesystem::path path = std::filesystem::canonical(task.volume, error);
    for (; !error; path = path.parent_path()) {
        if (std::filesystem::equivalent(path, task.project, error))
            fail(task.project.string(), ": holds the volume to import, ", task.volume.string(),
                 "; expected another name for the new project, since ", option_name(task.names, "overwrite"),
                 " removes this one with its annotation");
        if (path == path.parent_path()) return;
        error.clear();  // no project exists there yet
    }
}

void check(const ImportTask& task)
{
    const auto name = [&](const char* key) { return option_name(task.names, key); };
    if (!task.raw.empty()) static_cast<void>(parse_raw_layout(task.raw));
    if (!task.raw.empty() && task.choice.spacing && task.choice.unit.empty())
        throw UsageError(sentence(name("spacing"), " is given without a unit; expected ", name("unit"), ", too, as in ",
                                  name("unit"), " um"));
    for (int axis = 0; axis < 3; ++axis) {
        const double sigma = task.blur_voxels[axis];
        if (!(sigma >= 0.0 && sigma <= MAX_SIGMA))
            throw UsageError(sentence(name("blur"), " is ", sigma, "; expected sigmas of 0 to ", MAX_SIGMA, " voxels"));
    }
    if (task.downscale < 1 || task.downscale > MAX_DOWNSCALE)
        throw UsageError(sentence(name("downscale"), " is ", task.downscale, "; expected 1 to ", MAX_DOWNSCALE));
    if (task.shards && task.version != OmeZarrVersion::v0_5)
        throw UsageError(sentence(name("shards"), task.names == OptionNames::command_line ? " is given" : " is true",
                                  " without ", name("ome_zarr"),
                                  " 0.5; expected both, since OME-Zarr 0.4 has no shards"));
    if (task.allows_incomplete && (task.reverse || task.blur_voxels != glm::dvec3(0.0) || task.downscale != 1))
        throw UsageError(sentence(name("allow_incomplete"), " is given with ",
                                  name(task.reverse          ? "reverse"
                                       : task.downscale != 1 ? "downscale"
                                                             : "blur"),
                                  "; expected no preparation but ", name("crop"),
                                  ", since it would mix what cannot be read with the rest"));
    check_threads(task.threads, task.names);
    if (task.budget_host_mib < 0 || task.budget_host_mib > MAX_BUDGET_MIB)
        throw UsageError(sentence(name("budget_host_mib"), " is ", task.budget_host_mib, "; expected 0 to ",
                                  MAX_BUDGET_MIB, " MiB"));
    if (task.volume.empty() || task.project.empty())
        throw UsageError(sentence("no ", name(task.volume.empty() ? "volume" : "project"), " is given; expected both"));
}

namespace {

/// Keeps other processes from writing annotation into a project that is to be replaced, since that deletes it.
std::shared_ptr<Hold> hold_replaced(const ImportTask& task)
{
    if (!task.overwrite) return nullptr;
    const std::filesystem::path session = task.project / "shvr" / "session.json";
    std::shared_ptr<Hold> hold = Hold::take(journal_beside(session), task.program);
    if (hold && !hold->doubtful().empty())
        throw JournalTaken(sentence(hold->journal().string(), ": is open for writing in ",
                                    in_words(hold->doubtful().front()),
                                    "; expected no writer of a project that is to be replaced"));
    return hold;
}

ImportOptions options_of(const ImportTask& task, ImportListener& listener, ProgressReporter& reporter, Gaps* gaps)
{
    return {.preparation = {.crop = task.crop,
                            .reverse = task.reverse,
                            .blur_sigma_voxels = task.blur_voxels,
                            .downscale = task.downscale},
            .halving = task.labels ? Halving::label : Halving::mean,
            .choice = sentence(task.choice.channel, "\n", task.choice.frame, "\n", task.raw,
                               task.choice.level > 0 ? sentence("\nlevel ", task.choice.level) : "",
                               task.allows_incomplete ? "\nincomplete" : ""),
            .overwrites = task.overwrite,
            .threads = task.threads,
            .budget_host_bytes = task.budget_host_mib << 20,
            .version = task.version,
            .has_shards = task.shards,
            .progress = [&](const ImportProgress& progress) { listener.take(progress); },
            .cancel = &reporter.stop_requested(),
            .gaps = task.allows_incomplete ? gaps : nullptr,
            .tells_commands = task.names == OptionNames::command_line};
}

/// Opens the source of a task and calls `import`, which makes a report.
template <class Run>
ImportResult timed(const ImportTask& task, ProgressReporter& reporter, const Run& import)
{
    using Clock = std::chrono::steady_clock;
    if (task.overwrite) refuse_own_source(task);
    const Clock::time_point begin = Clock::now();
    const std::unique_ptr<VolumeSource> source = open_for_import(task);
    Gaps gaps = gaps_of(task.allows_incomplete, task.names);
    const GapSource readable(*source, gaps);
    ImportListener listener(task, source->info().type, reporter);
    ImportResult result;
    try {
        result.report = import(readable, options_of(task, listener, reporter, &gaps));
    } catch (const ImportStopped& stopped) {
        throw Stopped(stopped.what());
    }
    result.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    if (!result.report.project.empty()) warn_of_labels(task, gaps, result.report);  // a piece is no project
    const VolumeInfo& info = result.report.info;
    result.megabytes_per_second = double(voxel_count(info)) * double(bytes_of(info.type)) / result.seconds / 1e6;
    return result;
}

}  // namespace

ImportResult run(const ImportTask& task, ProgressReporter& reporter)
{
    check(task);
    const std::shared_ptr<Hold> hold = hold_replaced(task);
    return timed(task, reporter, [&](const VolumeSource& source, const ImportOptions& options) {
        return import_volume(source, task.volume, task.project, options);
    });
}

void check_part(const ImportTask& task)
{
    check(task);
    if (task.allows_incomplete)
        throw UsageError(sentence(option_name(task.names, "allow_incomplete"),
                                  " is given for one of several tasks; expected an import by one process, which lists "
                                  "all that it could not read"));
}

void run_part(const ImportTask& task, const TaskChoice& choice, const std::filesystem::path& piece,
              ProgressReporter& reporter)
{
    check_part(task);
    check_target(task.project, task.overwrite);  // which joining would refuse, after all tasks
    static_cast<void>(timed(task, reporter, [&](const VolumeSource& source, const ImportOptions& options) {
        import_piece(source, task.volume, piece, options, choice);
        return ImportReport{.info = source.info()};
    }));
}

ImportResult join_parts(const ImportTask& task, const std::vector<std::filesystem::path>& pieces,
                        ProgressReporter& reporter)
{
    check_part(task);
    if (!task.overwrite && is_target_taken(task.project))
        fail(task.project.string(),
             ": already exists, as it does once the pieces are joined; expected no such folder: remove it to join them "
             "again");
    const std::shared_ptr<Hold> hold = hold_replaced(task);
    return timed(task, reporter, [&](const VolumeSource& source, const ImportOptions& options) {
        return join_import(source, task.volume, task.project, options, pieces);
    });
}

}  // namespace shvr

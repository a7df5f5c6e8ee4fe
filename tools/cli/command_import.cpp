// shvr import: makes a project from a volume. Needs no Vulkan device.

#include <sys/resource.h>

#include <charconv>
#include <iomanip>

#include "engine/base/atomic_writer.h"
#include "engine/tasks/task_parts.h"
#include "tools/cli/array/split_job.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

namespace {

struct ImportCommandOptions {
    Common common;
    std::string volume, project, crop, blur = "0";
    std::string split;  ///< as add_task_option has it
    ImportTask task{.names = OptionNames::command_line};
};

// ---- Numbers of options ---------------------------------------------------------------------------------------------

/// Parses numbers separated by commas, such as "1,2,3"; null if one of the parts is not a number.
template <class Value>
std::vector<Value> numbers_of(const std::string& text)
{
    std::vector<Value> values;
    const char* at = text.data();
    const char* const end = at + text.size();
    for (;;) {
        Value value{};
        const auto result = std::from_chars(at, end, value);
        if (result.ec != std::errc()) return {};
        values.push_back(value);
        if (result.ptr == end) return values;
        if (*result.ptr != ',') return {};
        at = result.ptr + 1;
    }
}

[[noreturn]] void refuse(const char* option, const std::string& text, const std::string& expected)
{
    throw UsageError(sentence(option, " is '", text, "'; expected ", expected));
}

std::optional<VoxelBox> parse_crop(const std::string& text)
{
    if (text.empty()) return std::nullopt;
    const std::vector<int64_t> sides = numbers_of<int64_t>(text);
    if (sides.size() != 6) {
        refuse("--crop", text, "X0,Y0,Z0,X1,Y1,Z1 in voxels, the last ones not included, as in 0,0,100,512,512,300");
    }
    return VoxelBox{{sides[0], sides[1], sides[2]}, {sides[3], sides[4], sides[5]}};
}

glm::dvec3 parse_blur(const std::string& text)
{
    const std::string expected =
        sentence("one sigma or three, X,Y,Z, in voxels, each 0 to ", MAX_SIGMA, ", as in 1.5 or 1.5,1.5,0.5");
    const std::vector<double> sigmas = numbers_of<double>(text);
    for (const double sigma : sigmas) {
        if (!(sigma >= 0.0 && sigma <= MAX_SIGMA)) refuse("--blur", text, expected);
    }
    if (sigmas.size() == 1) return glm::dvec3(sigmas[0]);
    if (sigmas.size() != 3) refuse("--blur", text, expected);
    return {sigmas[0], sigmas[1], sigmas[2]};
}

double peak_rss_mib()
{
    struct rusage usage {};
    ::getrusage(RUSAGE_SELF, &usage);
    return double(usage.ru_maxrss) / 1024.0;
}

void run_import(const ImportCommandOptions& options)
{
    ImportTask task = options.task;
    task.volume = options.volume;
    // If the project's path is a symbolic link, keeps the link and makes the project at the link's target.
    std::error_code ignored;
    const bool is_link = std::filesystem::is_symlink(options.project, ignored);
    task.project = is_link ? link_target(options.project) : std::filesystem::path(options.project);
    task.crop = parse_crop(options.crop);
    task.blur_voxels = parse_blur(options.blur);
    task.threads = options.common.threads;
    task.budget_host_mib = int64_t(options.common.budget_host_mib);
    SplitJob job(options.split, task.project, options.common);
    if (job.is_split()) check_part(task);
    job.begin({task.volume});
    if (job.is_task() && job.is_done()) return job.report();
    LongWork work(options.common.quiet);
    if (job.is_task()) {
        run_part(task, job.choice(), job.piece(), work);
        return job.report();
    }
    const ImportResult result = job.gathers() ? join_parts(task, job.all_pieces(), work) : run(task, work);
    const ImportReport& report = result.report;
    const VolumeInfo& info = report.info;
    clear_progress();
    warn(report.warnings, options.common);
    if (!options.common.json) {
        return say(options.common,
                   sentence(report.project.string(), ": ", info.size.x, " x ", info.size.y, " x ", info.size.z,
                            " voxels in ", report.levels, " levels, ", std::fixed, std::setprecision(1),
                            double(report.bytes) / 1048576.0, " MiB, ", result.seconds, " s"));
    }
    print({{"project", report.project.string()},
           {"size", {info.size.x, info.size.y, info.size.z}},
           {"type", name_of(info.type)},
           {"spacing", {info.spacing.x, info.spacing.y, info.spacing.z}},
           {"unit", info.unit},
           {"spacing_from", name_of(info.spacing_from)},
           {"unit_from", name_of(info.unit_from)},
           {"levels", report.levels},
           {"bricks", report.bricks},
           {"bricks_stored", report.bricks_stored},
           {"bytes", report.bytes},
           {"seconds", result.seconds},
           {"megabytes_per_second", result.megabytes_per_second},
           {"peak_rss_mib", peak_rss_mib()},
           {"resumed", report.was_resumed},
           {"complete", report.voxels_not_read == 0},
           {"voxels_not_read", report.voxels_not_read},
           {"warnings", report.warnings}});
}

}  // namespace

void add_import(CLI::App& program)
{
    auto options = std::make_shared<ImportCommandOptions>();
    CLI::App* command = program.add_subcommand("import", "Makes a project of a volume");
    command->add_option("VOLUME", options->volume, "Volume file or folder, or the address of an OME-Zarr")->required();
    command->add_option("PROJECT", options->project, "Folder to make; an OME-Zarr image")->required();
    command
        ->add_option("--crop", options->crop, "Take a box out of the volume, in voxels; the second corner is outside")
        ->type_name("X0,Y0,Z0,X1,Y1,Z1");
    command->add_flag("--reverse", options->task.reverse,
                      "Swap dark and bright: the whole volume's smallest plus largest value, minus the voxel");
    command
        ->add_option(
            "--blur", options->blur,
            "Gaussian blur to 4 sigma: sigma in voxels, of all axes or of each; the outermost voxels are repeated "
            "beyond the border")
        ->type_name("S|SX,SY,SZ");
    command->add_option("--downscale", options->task.downscale, "Make it N times smaller along every axis")
        ->type_name("N")
        ->check(CLI::Range(1, MAX_DOWNSCALE));
    command->add_flag("--labels", options->task.labels,
                      "The voxels are labels: coarser levels hold the most frequent one instead of a mean");
    command->add_option("--raw", options->task.raw, "How a file of bare voxels is laid out")
        ->type_name("WxHxD:TYPE[:big|little][:OFFSET]");
    add_spacing_options(
        *command, [options](const glm::dvec3& spacing) { options->task.choice.spacing = spacing; },
        [options](const std::string& unit) { options->task.choice.unit = unit; });
    command->add_option("--channel", options->task.choice.channel, "What to take from a file with channels")
        ->type_name("NAME|N");
    command
        ->add_option("--level", options->task.choice.level,
                     "Which size to take from a file with several: 0 the finest, 1, 2, ...")
        ->type_name("N")
        ->check(CLI::Range(0, 23));
    command->add_option("--frame", options->task.choice.frame, "Which time point to take from a file with several")
        ->type_name("N");
    add_task_option(*command, options->split);
    add_version_option(*command, options->task.version, "0.4 unless given");
    command->add_flag("--shards", options->task.shards,
                      "With --ome-zarr 0.5: up to 512 chunks in a file, for storage that dislikes many small files");
    command->add_flag("--overwrite", options->task.overwrite,
                      "Replace the project PROJECT, with all annotations in it, once the new one is complete");
    add_incomplete_option(*command, options->task.allows_incomplete,
                          "Give voxels that cannot be read the lowest value of their type, or NaN, with a warning that "
                          "the project keeps, instead of failing");
    command->add_option("--threads", options->common.threads, "Worker threads; 0: one per core")
        ->check(CLI::Range(0, 1024));
    add_host_budget_option(*command, options->common,
                           "Host memory that the import may take; one that would take more is refused before it "
                           "begins. Three quarters of what the process was given unless stated");
    add_output_options(*command, options->common);
    command->footer(
        "The order is: crop, reverse, blur, downscale. An interrupted import continues when it is run again.\n"
        "Example:\n  shvr import scan.nhdr scan --blur 1 --downscale 2 --json\n  shvr view scan");
    command->callback([options] { run_import(*options); });
}

}  // namespace shvr::cli

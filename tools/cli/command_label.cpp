// shvr label: labels connected components of a whole volume, which may exceed memory. Needs no Vulkan device.

#include "engine/annotation/work/work_offsets.h"
#include "engine/tasks/task_parts.h"
#include "tools/cli/array/split_job.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

namespace {

struct LabelCommandOptions {
    Common common;
    std::string volume, output;
    std::string split;  ///< as add_task_option has it
    int connectivity = 6;
    LabelTask task{.names = OptionNames::command_line};
};

void run_label(const LabelCommandOptions& options)
{
    LabelTask task = options.task;
    task.connectivity = options.connectivity == 6 ? Connectivity::faces : Connectivity::corners;
    task.output = options.output;
    task.threads = options.common.threads;
    check(task);
    if (!options.split.empty() && options.output.empty())
        throw UsageError("--task is given without --output; expected both, since the pieces lie next to the output");
    SplitJob job(options.split, options.output, options.common);
    LongWork work(options.common.quiet);
    const UnmeasuredSession opened = open_unmeasured_session(options.volume, options.common.settings);
    job.begin(inputs_of(options.volume, opened.session));
    if (job.is_task() && job.is_done()) return job.report();
    const VolumeInfo info = opened.source->info();
    check(task, *opened.source, opened.session.volume_path);
    warn(info.warnings, options.common);
    warn_of_losses(opened.losses);
    warn_of_holder(opened.session.journal_path, options.common);
    std::vector<Notice> notices;
    const DensityField offsets = offsets_of(work_files(opened.session, info), options.common.belief, notices);
    warn(notices, options.common);
    const std::shared_ptr<const VolumeSource> source = with_offsets(opened.source, offsets);
    if (job.is_task()) {
        run_part(task, *source, options.volume, job.choice(), job.piece(), work);
        return job.report();
    }
    const LabelResult result = job.gathers() ? join_parts(task, *source, options.volume, job.all_pieces(), work)
                                             : run(task, *source, options.volume, work);
    warn(result.warnings, options.common);
    const Components::Counts& counts = result.counts;
    if (!options.common.json) {
        say(options.common, sentence(counts.found, " components of ", counts.foreground_voxels,
                                     " voxels, the largest of ", counts.largest_voxels, "; kept ", counts.kept, " of ",
                                     counts.kept_voxels, "; ", result.seconds, " s"));
        return;
    }
    std::vector<std::string> warnings = info.warnings;
    warnings.insert(warnings.end(), result.warnings.begin(), result.warnings.end());
    Json largest = Json::array();
    for (const Components::Component& component : counts.largest)
        largest.push_back({{"label", component.label}, {"voxels", component.voxels}});
    print({{"components", counts.found},
           {"foreground_voxels", counts.foreground_voxels},
           {"largest_voxels", counts.largest_voxels},
           {"seconds", result.seconds},
           {"label_seconds", result.label_seconds},
           {"megavoxels_per_second", double(voxel_count(info)) / result.label_seconds / 1e6},
           {"kept", counts.kept},
           {"kept_voxels", counts.kept_voxels},
           {"largest", largest},
           {"size", {info.size.x, info.size.y, info.size.z}},
           {"threshold", task.threshold},
           {"connectivity", options.connectivity},
           {"output", options.output.empty() ? Json(nullptr) : Json(options.output)},
           {"type", result.type ? Json(name_of(*result.type)) : Json(nullptr)},
           {"peak_bytes", counts.peak_bytes},
           {"provisional_labels", counts.provisional},
           {"run_file_bytes", counts.run_file_bytes},
           {"voxels_with_offset", offsets.voxels()},
           {"complete", result.voxels_not_read == 0},
           {"voxels_not_read", result.voxels_not_read},
           {"warnings", warnings}});
}

}  // namespace

void add_label(CLI::App& program)
{
    auto options = std::make_shared<LabelCommandOptions>();
    CLI::App* command = program.add_subcommand("label", "Finds the connected components of a whole volume");
    command->add_option("VOLUME", options->volume, "Volume, project folder or session (.json)")->required();
    command->add_option("--threshold", options->task.threshold, "Voxels at or above it belong to components")
        ->required();
    command->add_option("--connectivity", options->connectivity, "Voxels are joined over faces, or over corners too")
        ->check(CLI::IsMember({6, 26}));
    command->add_option("--min-voxels", options->task.fewest_voxels, "Leave out smaller components")
        ->check(CLI::Range(int64_t{1}, int64_t{1} << 62));
    command->add_option("--largest", options->task.largest, "Keep only the N largest; of equal ones the first")
        ->type_name("N")
        ->check(CLI::Range(int64_t{1}, int64_t{1} << 32));
    command->add_option("-o,--output", options->output,
                        "The labels, from 1 in the order of first voxels (.zarr: OME-Zarr labels; .nrrd, .tif; .mask)");
    add_task_option(*command, options->split);
    add_version_option(*command, options->task.version, "unless given, as the image or the labels there are, or 0.4");
    add_incomplete_option(*command, options->task.allows_incomplete,
                          "Take voxels that cannot be read for dark ones, with a warning, instead of failing");
    command->add_option("--threads", options->common.threads, "Worker threads; 0: one per core")
        ->check(CLI::Range(0, 1024));
    add_belief_option(*command, options->common);
    add_input_options(*command, options->common);
    add_output_options(*command, options->common);
    command->footer(
        "Density offsets of a session or project are added to its voxels. Memory follows the size of a slice and the "
        "number of components.\n"
        "Example:\n  shvr label scan/ --threshold 120 --min-voxels 50 -o scan/labels/parts --json");
    command->callback([options] { run_label(*options); });
}

}  // namespace shvr::cli

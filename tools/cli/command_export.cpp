// shvr export: writes annotations in the formats of other programs, and their measurements. Needs no Vulkan device.

#include <span>

#include "engine/annotation/work/work.h"
#include "engine/base/atomic_file.h"
#include "engine/base/file.h"
#include "engine/base/text.h"
#include "engine/tasks/surface_task.h"
#include "engine/volume/unit.h"
#include "tools/cli/array/split_job.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

namespace {

struct ExportCommandOptions {
    Common common;
    std::string project, mask, offset, trace, mesh, surface, metrics, measurements;
    std::string space = "physical";
    std::string split;  ///< as add_task_option has it
    ExportTask task{.names = OptionNames::command_line};
    SurfaceTask surface_task{.names = OptionNames::command_line};
};

ExportTask task_of(const ExportCommandOptions& options)
{
    ExportTask task = options.task;
    task.mask = options.mask;
    task.offset = options.offset;
    task.trace = options.trace;
    task.mesh = options.mesh;
    task.metrics = options.metrics;
    task.measurements = options.measurements;
    task.space = options.space == "volume" ? Positions::volume : Positions::physical;
    return task;
}

/// Null if no surface is wanted.
std::optional<SurfaceTask> surface_task_of(const ExportCommandOptions& options)
{
    if (options.surface.empty()) return std::nullopt;
    SurfaceTask task = options.surface_task;
    // "GROUPS:FILE", or "FILE", whose folders may hold a colon.
    const size_t colon = options.surface.find(':');
    const bool names_groups = colon != std::string::npos && options.surface.find('/') > colon;
    if (names_groups) task.groups = options.surface.substr(0, colon);
    if (names_groups && colon == 0)
        throw UsageError(sentence("--surface is ", in_quotes(options.surface), "; expected GROUPS:FILE or FILE"));
    task.surface = names_groups ? options.surface.substr(colon + 1) : options.surface;
    task.space = task_of(options).space;
    task.budget_host_mib = int64_t(options.common.budget_host_mib);
    return task;
}

/// Fails if a surface has the name of another output.
void check_names(const SurfaceTask& surface, const std::vector<std::filesystem::path>& files, const ExportTask& task)
{
    const auto plain = [](const std::filesystem::path& path) {
        return std::filesystem::absolute(path).lexically_normal();
    };
    for (const std::filesystem::path& file : files)
        for (const std::filesystem::path& other :
             {task.mask, task.offset, task.trace, task.mesh, task.metrics, task.measurements})
            if (!other.empty() && plain(other) == plain(file))
                throw UsageError(sentence(option_name(surface.names, "surface"), " and another option name '",
                                          file.string(), "'; expected two names"));
}

template <class Value>
Json by_group(const std::map<int, Value>& values, double factor)
{
    Json object = Json::object();
    for (const auto& [group, value] : values) object[std::to_string(group)] = value * Value(factor);
    return object;
}

Json to_json(const ExportResult& result, const SurfaceResult& surfaces)
{
    std::vector<std::string> written = result.written;
    written.insert(written.end(), surfaces.written.begin(), surfaces.written.end());
    const std::optional<double> micrometres = micrometres_in(result.unit);
    return {{"written", written},
            {"voxels_by_group", by_group(result.voxels_by_group, 1.0)},
            {"nodes", result.nodes},
            {"internodes", result.internodes},
            {"length_um_by_group", micrometres ? by_group(result.length_by_group, *micrometres) : Json(nullptr)},
            {"length_by_group", by_group(result.length_by_group, 1.0)},
            {"unit", result.unit},
            {"triangles_by_group", by_group(surfaces.triangles_by_group, 1.0)},
            {"decimation_error", surfaces.decimation_error ? Json(*surfaces.decimation_error) : Json(nullptr)},
            {"left_out", result.left_out}};
}

/// What to write: everything that the command asks for, or the part of a task.
struct Outputs {
    ExportTask task;
    std::optional<SurfaceTask> surface;
};

/// Returns the file next to which pieces are: the first one that is written.
std::filesystem::path first_output(const ExportCommandOptions& options, const Outputs& outputs)
{
    const ExportTask& task = outputs.task;
    for (const std::filesystem::path& path :
         {task.mask, task.offset, task.trace, task.mesh, task.metrics, task.measurements})
        if (!path.empty()) return path;
    if (task.labels) return std::filesystem::path(options.project) / "labels" / "mask";
    if (outputs.surface) return outputs.surface->surface;
    throw UsageError("--task is given, but nothing to write; expected --mask, --trace or another output");
}

/// Leaves every N-th output, of those that N tasks write.
Outputs part_of(Outputs outputs, const TaskChoice& choice)
{
    int64_t number = 0;
    const auto is_other = [&](bool is_wanted) { return is_wanted && number++ % choice.of != choice.index; };
    ExportTask& task = outputs.task;
    for (std::filesystem::path* path :
         {&task.mask, &task.offset, &task.trace, &task.mesh, &task.metrics, &task.measurements})
        if (is_other(!path->empty())) path->clear();
    if (is_other(task.labels)) task.labels = false;
    if (task.metrics.empty()) {
        task.sections.clear();
        task.axis.clear();
    }
    if (is_other(outputs.surface.has_value())) outputs.surface.reset();
    return outputs;
}

/// Joins what the tasks have printed; their files are in place.
Json joined(const SplitJob& job)
{
    Json all;
    for (const std::filesystem::path& piece : job.all_pieces()) {
        const Json told = Json::parse(read_text(piece, int64_t{64} << 20), nullptr, false);
        const bool is_piece = told.is_object() && told.contains("written") && told.contains("left_out") &&
                              told.contains("triangles_by_group") && told.contains("decimation_error");
        if (!is_piece)
            fail(piece.string(),
                 ": is not the piece of a task of shvr export; expected one: remove it, and run the "
                 "task again");
        for (const Json& file : told["written"]) {
            std::error_code ignored;
            if (std::filesystem::exists(file.get<std::string>(), ignored)) continue;
            fail(file.get<std::string>(), ": is missing, and ", piece.string(),
                 " states that a task has written it; expected it: remove the piece, and run its task again");
        }
        if (all.is_null()) {
            all = told;
            continue;
        }
        for (const char* key : {"written", "left_out"})
            for (const Json& each : told[key]) all[key].push_back(each);
        all["triangles_by_group"].update(told["triangles_by_group"]);
        if (!told["decimation_error"].is_null()) all["decimation_error"] = told["decimation_error"];
    }
    return all;
}

Json write_outputs(const ExportCommandOptions& options, const Outputs& whole, const SplitJob& job)
{
    // Annotations in an archived project cannot be read, so an export would silently write empty files.
    if (const std::string archived = archived_project(options.project); !archived.empty()) fail(archived);
    LongWork long_work(options.common.quiet);
    Gaps gaps;  // ignored: annotation is exported even if parts of the scan are unreadable
    const OpenedSession opened =
        open_session(options.project, options.common.settings,
                     {.measure = {.progress = long_work.begin("measuring " + options.project), .gaps = &gaps}});
    warn(opened.removed, options.common);
    warn(opened.source->info().warnings, options.common);
    if (!gaps.empty())
        warn({sentence(options.project, ": ", gaps.in_words(),
                       "; whether the annotation is of this volume was not checked")},
             options.common);
    warn_of_losses(opened.losses);
    warn_of_holder(opened.session.journal_path, options.common);
    const VolumeInfo& volume = opened.source->info();
    Work work(volume.size, volume.type);
    static_cast<void>(long_work.begin("reading annotations"));
    warn(work.open(work_files(opened.session, volume), {.belief = options.common.belief, .only_look = true}),
         options.common);
    work.expect_choice();
    const Document& document = work.document();
    const AnnotationView annotation{.volume = volume,
                                    .mask = document.mask,
                                    .density = document.density,
                                    .trace = document.trace,
                                    .groups = opened.session.groups,
                                    .volume_hash = opened.session.volume_hash,
                                    .project = options.project,
                                    .volume_path = opened.session.volume_path,
                                    .trace_path = opened.session.trace_path,
                                    .mask_path = work.mask_of_header(),
                                    .measurements = opened.session.measurements};
    if (whole.surface) {
        check(whole.task, annotation);
        check(*whole.surface, annotation);
        check_names(*whole.surface, surface_files(*whole.surface, annotation.mask), whole.task);
    }
    const auto [task, surface_task] = job.is_task() ? part_of(whole, job.choice()) : whole;
    const ExportResult result = run(task, annotation, long_work, [&](const ExportResult& so_far) {
        // The trace is written first.
        if (so_far.written.size() == 1) warn(so_far.left_out, options.common);
        say(options.common, "wrote " + so_far.written.back());
    });
    SurfaceResult surfaces;
    if (surface_task)
        surfaces = run(*surface_task, annotation, long_work,
                       [&](const SurfaceResult& so_far) { say(options.common, "wrote " + so_far.written.back()); });
    return to_json(result, surfaces);
}

void run_export(const ExportCommandOptions& options)
{
    const Outputs whole{task_of(options), surface_task_of(options)};
    check(whole.task);
    if (whole.surface) check(*whole.surface);
    SplitJob job(options.split, options.split.empty() ? std::filesystem::path("-") : first_output(options, whole),
                 options.common);
    if (job.gathers()) {
        job.begin({});
        return print(joined(job));
    }
    if (job.is_task()) {
        job.begin(
            inputs_of(options.project, open_unmeasured_session(options.project, options.common.settings).session));
        if (job.is_done()) return job.report();
    }
    const Json result = write_outputs(options, whole, job);
    if (job.is_task()) {
        const std::string text = result.dump();
        write_file_atomically(job.piece(), std::as_bytes(std::span(text)));
        return job.report();
    }
    if (options.common.json) print(result);
}

}  // namespace

void add_export(CLI::App& program)
{
    auto options = std::make_shared<ExportCommandOptions>();
    CLI::App* command =
        program.add_subcommand("export", "Writes mask, offsets, trace, surfaces and measures for other programs");
    command->add_option("PROJECT", options->project, "Project folder or session (.json)")->required();
    command->add_option("--mask", options->mask, "The painted voxels (.mask, .nrrd, .tif; .zarr: OME-Zarr labels)");
    command->add_flag("--labels", options->task.labels,
                      "The painted voxels as OME-Zarr labels in the project, labels/mask");
    add_task_option(*command, options->split);
    add_version_option(*command, options->task.version, "unless given, as the project or the labels there are, or 0.4");
    command->add_option("--offset", options->offset, "The density offsets (.offset, .nrrd, .tif)");
    command->add_option("--trace", options->trace, "Nodes and internodes (.graphml, .txt, .swc, .rsml)");
    command->add_flag("--break-loops", options->task.break_loops,
                      "Open each loop where its last internode closed it, for .swc and .rsml, which hold trees");
    command->add_option("--mesh", options->mesh, "The trace as tubes (.obj, .ply)");
    CLI::Option* surface = command->add_option(
        "--surface", options->surface,
        "[GROUPS:]FILE, such as 3:stem.stl or 1+4:parts.glb: closed surfaces of these groups, or of all that are "
        "painted (.stl: a file for each group, unless one is named; .ply, .obj, .glb: one for all)");
    command
        ->add_option("--smooth", options->surface_task.smooth,
                     "Steps that smooth surfaces: no vertex moves by half a voxel, and each group keeps its volume "
                     "within 1 %; 0: the faces of voxels")
        ->type_name("STEPS")
        ->capture_default_str()
        ->check(CLI::Range(0, MAX_SURFACE_STEPS))
        ->needs(surface);
    command
        ->add_option(
            "--decimate", options->surface_task.decimate,
            "Share of the triangles of surfaces to keep, such as 0.1; more stay where the surface would be farther "
            "than the shortest side of a voxel from the full one, or a volume would change by 0.4 %, and "
            "where three groups meet. Groups that touch keep equal borders")
        ->type_name("SHARE")
        ->check(number_between(MIN_SURFACE_SHARE, 1.0))
        ->needs(surface);
    add_host_budget_option(
        *command, options->common,
        "Host memory that surfaces may take; unless stated, three quarters of what the process was given");
    command
        ->add_option("--space", options->space,
                     "Of trace, mesh, surfaces and measurements: physical, where other programs show the volume, with "
                     "the origin at "
                     "the centre "
                     "of voxel 0 unless the file states another place; or volume, voxel * spacing, with the origin at "
                     "the outer corner of voxel 0")
        ->check(CLI::IsMember({"physical", "volume"}));
    command->add_option("--metrics", options->metrics,
                        "Counts, lengths, angles, radii, topology, and patterns of flower heads (.csv)");
    command->add_option("--measurements", options->measurements,
                        "Distances, paths and angles measured in the window, with the unit in the headings (.csv)");
    command->add_option("--sections", options->task.sections,
                        "For --metrics: the groups of a flower head's parts, such as abaxial=1+4,adaxial=2,floret=3; "
                        "unless given, groups whose names have these words, or else 1, 2 and 3");
    command
        ->add_option("--axis", options->task.axis,
                     "For --metrics: a flower head's axis, where its trace does not determine it: a point and the "
                     "direction towards the florets, as traces are exported; unless given, fitted to the trace")
        ->type_name("X,Y,Z,DX,DY,DZ");
    add_belief_option(*command, options->common);
    add_input_options(*command, options->common);
    add_output_options(*command, options->common);
    command->footer(
        "Masks, offsets, traces, meshes and surfaces lie where the volume's file says: NRRD and OME-Zarr say it in "
        "their own "
        "way, "
        "traces,\nmeshes and surfaces in comments; in TIFF, which has no place for it, only SHVR reads it.\n"
        "Example:\n  shvr export scan/ --trace veins.swc --mesh veins.ply --metrics veins.csv\n"
        "  shvr export scan/ --surface 1+3:parts.glb --decimate 0.2");
    command->callback([options] { run_export(*options); });
}

}  // namespace shvr::cli

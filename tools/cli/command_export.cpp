// shvr export: annotations in formats of other programs, and their measures. Needs no device.

#include "engine/annotation/files/mask_image.h"
#include "engine/annotation/files/mask_import.h"
#include "engine/annotation/files/offset_export.h"
#include "engine/annotation/files/offset_file.h"
#include "engine/annotation/measures/measures.h"
#include "engine/annotation/trace/trace_mesh.h"
#include "engine/base/atomic_file.h"
#include "engine/session/label_looks.h"
#include "engine/volume/unit.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

namespace {

struct ExportCommandOptions {
    Common common;
    std::string project, mask, offset, trace, mesh, metrics;
    std::string space = "physical";
    bool break_loops = false, labels = false;
    std::optional<OmeZarrVersion> version;
};

void check_mask_name(const std::string& path)
{
    if (!path.empty() && !is_mask_export(path))
        throw UsageError(sentence("--mask is '", path, "'; expected a name that ends in one of: .mask, .nrrd, .tif, ",
                                  ".tiff, .zarr, or PROJECT/labels/NAME"));
}

/// PROJECT/labels/mask; empty if not requested.
std::string project_labels(const ExportCommandOptions& options)
{
    if (!options.labels) return {};
    const std::filesystem::path project = options.project;
    const bool is_image =
        std::filesystem::exists(project / ".zattrs") || std::filesystem::exists(project / "zarr.json");
    if (!is_image)
        fail(options.project, ": is no project folder; expected one, to write --labels into, or --mask with a name");
    return (project / "labels" / "mask").string();
}

/// Fails if there is neither a trace nor a file of one.
void expect_trace(const Session& session, const TraceGraph& trace)
{
    if (!trace.nodes().empty() || std::filesystem::exists(session.trace_path)) return;
    fail(session.trace_path.empty() ? "the session" : session.trace_path.string(),
         session.trace_path.empty() ? ": names no trace; expected the key annotation.trace"
                                    : ": does not exist; expected the trace that shvr annotate saves");
}

/// The topology of all painted voxels (-1), and of each group.
std::map<int, Topology> topology_by_group(const Mask& mask)
{
    std::map<int, Topology> topology{{-1, topology_of(mask)}};
    const std::array<int64_t, 256> voxels = mask.voxels_by_group();
    for (int group = 1; group < 256; ++group)
        if (voxels[size_t(group)] > 0) topology[group] = topology_of(mask, uint8_t(group));
    return topology;
}

Json to_json(const std::vector<std::string>& written, const Mask& mask, const TraceGraph& trace,
             const TraceSpace& space, const std::vector<std::string>& left_out)
{
    const TraceMeasures measures = measure(trace);
    const std::optional<double> micrometres = micrometres_in(space.unit);
    Json voxels = Json::object(), lengths = Json::object(), lengths_um = Json::object();
    const std::array<int64_t, 256> counts = mask.voxels_by_group();
    for (size_t group = 1; group < 256; ++group)
        if (counts[group] > 0) voxels[std::to_string(group)] = counts[group];
    for (const auto& [group, length] : measures.length_by_group) {
        lengths[std::to_string(group)] = length;
        if (micrometres) lengths_um[std::to_string(group)] = length * *micrometres;
    }
    return {{"written", written},
            {"voxels_by_group", voxels},
            {"nodes", trace.nodes().size()},
            {"internodes", trace.internodes().size()},
            {"length_um_by_group", micrometres ? lengths_um : Json(nullptr)},
            {"length_by_group", lengths},
            {"unit", space.unit},
            {"left_out", left_out}};
}

void run_export(const ExportCommandOptions& options)
{
    check_mask_name(options.mask);
    check_output("--offset", options.offset, {".offset", ".nrrd", ".tif", ".tiff"});
    check_output("--trace", options.trace, {".txt", ".swc", ".graphml", ".rsml"});
    check_output("--mesh", options.mesh, {".obj", ".ply"});
    check_output("--metrics", options.metrics, {".csv"});
    // Its annotations are in it, but empty files would be written.
    if (const std::string archived = archived_project(options.project); !archived.empty()) fail(archived);
    LongWork long_work(options.common.quiet);
    const OpenedSession opened =
        open_session(options.project, options.common.settings,
                     {.measure = {.progress = long_work.begin("measuring " + options.project)}});
    warn(opened.source->info().warnings, options.common);
    warn_of_losses(opened.losses);
    warn_of_holder(opened.session.journal_path, options.common);
    const VolumeInfo& volume = opened.source->info();
    const TraceSpace space = space_of(volume);
    Work work(volume.size, volume.type);
    static_cast<void>(long_work.begin("reading annotations"));
    warn(work.open(work_files(opened.session, volume), {.belief = options.common.belief, .only_look = true}),
         options.common);
    work.expect_choice();
    const Mask& mask = work.document().mask;
    const TraceGraph& trace = work.document().trace;
    if (!options.trace.empty() || !options.mesh.empty()) expect_trace(opened.session, trace);

    const Positions positions = options.space == "volume" ? Positions::volume : Positions::physical;
    std::vector<std::string> written, left_out;
    const auto wrote = [&](const std::string& path) {
        written.push_back(path);
        say(options.common, "wrote " + path);
    };
    if (!options.trace.empty()) {
        static_cast<void>(long_work.begin("writing " + options.trace));
        left_out =
            save_trace(options.trace, trace, space, options.break_loops ? Loops::break_open : Loops::refuse, positions);
        warn(left_out, options.common);
        wrote(options.trace);
    }
    for (const std::string& path : {options.mask, project_labels(options)}) {
        if (path.empty()) continue;
        export_mask(path, mask, volume,
                    {.colors = label_looks(opened.session.groups, mask), .painted_on = opened.session.volume_hash},
                    options.version, long_work.begin("writing " + path));
        wrote(path);
    }
    if (!options.offset.empty()) {
        export_offsets(options.offset, work.document().density, volume, long_work.begin("writing " + options.offset));
        wrote(options.offset);
    }
    if (!options.mesh.empty()) {
        static_cast<void>(long_work.begin("writing " + options.mesh));
        save_trace_mesh(options.mesh, trace, space, positions);
        wrote(options.mesh);
    }
    if (!options.metrics.empty()) {
        static_cast<void>(long_work.begin("measuring what is painted"));
        const std::string text = metrics_csv(measure(trace), mask.voxels_by_group(), topology_by_group(mask), space);
        write_file_atomically(options.metrics, std::as_bytes(std::span(text)));
        wrote(options.metrics);
    }
    if (options.common.json) print(to_json(written, mask, trace, space, left_out));
}

}  // namespace

void add_export(CLI::App& program)
{
    auto options = std::make_shared<ExportCommandOptions>();
    CLI::App* command = program.add_subcommand("export", "Writes mask, offsets, trace and measures for other programs");
    command->add_option("PROJECT", options->project, "Project folder or session (.json)")->required();
    command->add_option("--mask", options->mask, "The painted voxels (.mask, .nrrd, .tif; .zarr: OME-Zarr labels)");
    command->add_flag("--labels", options->labels, "The painted voxels as OME-Zarr labels in the project, labels/mask");
    add_version_option(*command, options->version, "unless given, as the project or the labels there are, or 0.4");
    command->add_option("--offset", options->offset, "The density offsets (.offset, .nrrd, .tif)");
    command->add_option("--trace", options->trace, "Nodes and internodes (.graphml, .txt, .swc, .rsml)");
    command->add_flag("--break-loops", options->break_loops,
                      "Open each loop where its last internode closed it, for .swc and .rsml, which hold trees");
    command->add_option("--mesh", options->mesh, "The trace as tubes (.obj, .ply)");
    command
        ->add_option("--space", options->space,
                     "Of trace and mesh: physical, where other programs show the volume; or volume, voxel * spacing")
        ->check(CLI::IsMember({"physical", "volume"}));
    command->add_option("--metrics", options->metrics, "Counts, lengths, angles, radii, topology (.csv)");
    add_belief_option(*command, options->common);
    add_input_options(*command, options->common);
    add_output_options(*command, options->common);
    command->footer(
        "Masks, offsets, traces and meshes lie where the volume's file says: NRRD and OME-Zarr say it in their own "
        "way, "
        "traces\nand meshes in comments; in TIFF, which has no place for it, only SHVR reads it.\n"
        "Example:\n  shvr export scan/ --trace veins.swc --mesh veins.ply --metrics veins.csv");
    command->callback([options] { run_export(*options); });
}

}  // namespace shvr::cli

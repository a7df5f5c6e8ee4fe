#include "engine/tasks/export_task.h"

#include <array>

#include "engine/annotation/files/mask_export.h"
#include "engine/annotation/files/mask_segments.h"
#include "engine/annotation/files/offset_export.h"
#include "engine/annotation/measures/measures.h"
#include "engine/annotation/patterns/head.h"
#include "engine/annotation/patterns/stated_axis.h"
#include "engine/annotation/trace/trace_mesh.h"
#include "engine/base/atomic_file.h"
#include "engine/base/text.h"
#include "engine/session/label_looks.h"
#include "engine/tasks/surface_task.h"
#include "engine/tasks/task_output.h"

namespace shvr {

namespace {

/// Returns PROJECT/labels/mask; empty if not requested.
std::filesystem::path project_labels(const ExportTask& task, const std::filesystem::path& project)
{
    if (!task.labels) return {};
    const bool is_image =
        std::filesystem::exists(project / ".zattrs") || std::filesystem::exists(project / "zarr.json");
    if (!is_image)
        fail(project.string(), ": is no project folder; expected one, to write ", option_name(task.names, "labels"),
             " into, or ", option_name(task.names, "mask"), " with a name");
    return project / "labels" / "mask";
}

/// Fails if there is neither a trace nor a file to read it from.
void expect_trace(const AnnotationView& annotation)
{
    const std::filesystem::path& path = annotation.trace_path;
    if (!annotation.trace.nodes().empty() || std::filesystem::exists(path)) return;
    if (path.empty()) fail("the session: names no trace; expected the key annotation.trace");
    fail(path.string(),
         ": does not exist: nothing is traced; expected the trace that the window or shvr annotate saves");
}

ExportResult summary_of(const AnnotationView& annotation)
{
    ExportResult result{.nodes = annotation.trace.nodes().size(),
                        .internodes = annotation.trace.internodes().size(),
                        .unit = annotation.volume.unit};
    const std::array<int64_t, 256> counts = annotation.mask.voxels_by_group();
    for (int group = 1; group < 256; ++group)
        if (counts[size_t(group)] > 0) result.voxels_by_group[group] = counts[size_t(group)];
    for (const auto& [group, length] : measure(annotation.trace).length_by_group)
        result.length_by_group[group] = length;
    return result;
}

HeadSections sections_of(const ExportTask& task, const Groups& groups)
{
    return head_sections(task.sections, option_name(task.names, "sections"), [&](uint8_t group) {
        const auto found = groups.find(group);
        return found == groups.end() ? SectionGroup{} : SectionGroup{found->second.name, parent_of(groups, group)};
    });
}

/// Returns the rows of a flower head's pattern. Returns an empty text for other plants, which have no such rows: if the
/// user states no sections and no node belongs to a usual group of adaxial veins or florets.
std::string pattern_text(const ExportTask& task, const AnnotationView& annotation, const TraceSpace& space)
{
    const HeadSections sections = sections_of(task, annotation.groups);
    const auto is_of_head = [&](const auto& numbered) {
        const HeadPart part = sections.parts[numbered.second.group];
        return part == HeadPart::adaxial || part == HeadPart::floret;
    };
    if (annotation.trace.nodes().empty()) return {};
    if (!sections.is_stated && std::ranges::none_of(annotation.trace.nodes(), is_of_head)) return {};
    const std::optional<StatedAxis> axis = stated_axis(task.axis, option_name(task.names, "axis"));
    return pattern_csv(measure_patterns(annotation.trace, sections, space, axis), space.unit);
}

SurfaceTask surface_task_of(const ExportTask& task)
{
    return {.surface = task.surface,
            .groups = task.surface_groups,
            .smooth = task.smooth,
            .decimate = task.decimate,
            .space = task.space,
            .budget_host_mib = task.budget_host_mib,
            .names = task.names};
}

std::filesystem::path plain(const std::filesystem::path& path)
{
    return std::filesystem::absolute(path).lexically_normal();
}

}  // namespace

void fields(Fields& f, ExportTask& task)
{
    f.path("mask", task.mask, {.meaning = "the painted voxels: .mask, .nrrd, .tif, .zarr", .standard = "none"});
    f.flag("labels", task.labels, {"the painted voxels as OME-Zarr labels in the project, labels/mask"});
    version_field(f, task.version, "version of OME-Zarr; automatic: as the project or the labels there are, or 0.4");
    f.path("offset", task.offset, {.meaning = "the density offsets: .offset, .nrrd, .tif, .zarr", .standard = "none"});
    f.path("trace", task.trace, {.meaning = "nodes and internodes: .graphml, .txt, .swc, .rsml", .standard = "none"});
    f.flag("break_loops", task.break_loops,
           {"each loop is opened where its last internode closed it, for .swc and .rsml, which hold trees"});
    f.path("mesh", task.mesh, {.meaning = "the trace as tubes: .obj, .ply", .standard = "none"});
    f.choice("space", task.space, {"of trace and mesh: where other programs show the volume, or voxel * spacing"});
    f.path("metrics", task.metrics,
           {.meaning = "counts, lengths, angles, radii, topology, patterns of flower heads: .csv", .standard = "none"});
    f.path("measurements", task.measurements,
           {.meaning = "distances, paths and angles measured in the window, with the unit in the headings: .csv",
            .standard = "none"});
    f.text("sections", task.sections,
           {.meaning = "for metrics, the groups of a flower head's parts, such as abaxial=1+4,adaxial=2,floret=3",
            .standard = "groups whose names have these words, or 1, 2, 3"});
    f.text("axis", task.axis,
           {.meaning = "for metrics, a flower head's axis where its trace does not determine it: a point and the "
                       "direction towards the florets, X,Y,Z,DX,DY,DZ, as traces are exported",
            .standard = "fitted to the trace"});
    f.path("surface", task.surface,
           {.meaning = "painted groups as closed surfaces: .stl (a file for each group), .ply, .obj, .glb",
            .standard = "none"});
    f.text("surface_groups", task.surface_groups,
           {.meaning = "groups of surface, such as 3 or 1+4", .standard = "all that are painted"});
    surface_form_fields(f, task);
}

std::vector<std::filesystem::path> replaced_files(const ExportTask& task)
{
    std::vector<std::filesystem::path> found;
    for (const auto& path : {task.mask, task.offset, task.trace, task.mesh, task.metrics, task.measurements}) {
        std::error_code ignored;
        if (!path.empty() && std::filesystem::exists(path, ignored)) found.push_back(path);
    }
    for (const std::filesystem::path& path : replaced_files(surface_task_of(task))) found.push_back(path);
    return found;
}

AnnotationSnapshot::AnnotationSnapshot(const AnnotationView& view)
    : volume_(view.volume),
      mask_(view.mask),
      density_(view.density),
      trace_(view.trace),
      groups_(view.groups),
      volume_hash_(view.volume_hash),
      project_(view.project),
      volume_path_(view.volume_path),
      trace_path_(view.trace_path),
      mask_path_(view.mask_path),
      measurements_(view.measurements.begin(), view.measurements.end())
{}

AnnotationView AnnotationSnapshot::view() const
{
    return {volume_,  mask_,        density_,    trace_,     groups_,      volume_hash_,
            project_, volume_path_, trace_path_, mask_path_, measurements_};
}

void check(const ExportTask& task)
{
    const auto name = [&](const char* key) { return option_name(task.names, key); };
    if (!task.mask.empty() && !is_mask_export(task.mask))
        throw UsageError(sentence(name("mask"), " is '", task.mask.string(),
                                  "'; expected a name that ends in one of: .mask, .nrrd, .tif, .tiff, .zarr, or ",
                                  "PROJECT/labels/NAME"));
    if (is_label_image(task.mask))
        check_output_folder(task.mask);
    else if (!task.mask.empty())
        check_output_place(task.mask);
    const std::pair<const char*, const std::filesystem::path&> outputs[] = {{"mask", task.mask},
                                                                            {"offset", task.offset},
                                                                            {"trace", task.trace},
                                                                            {"mesh", task.mesh},
                                                                            {"metrics", task.metrics},
                                                                            {"surface", task.surface},
                                                                            {"measurements", task.measurements}};
    for (const auto& [key, path] : outputs)
        for (const auto& [other, same] : outputs)
            if (&path != &same && !path.empty() && !same.empty() && plain(path) == plain(same))
                throw UsageError(
                    sentence(name(key), " and ", name(other), " are both '", path.string(), "'; expected two names"));
    if (lower_case(task.offset.extension().string()) == ".zarr")
        check_output_folder(task.offset);
    else
        check_output(name("offset"), task.offset, {".offset", ".nrrd", ".tif", ".tiff", ".zarr"});
    check_output(name("trace"), task.trace, {".txt", ".swc", ".graphml", ".rsml"});
    check_output(name("mesh"), task.mesh, {".obj", ".ply"});
    check_output(name("metrics"), task.metrics, {".csv"});
    check_output(name("measurements"), task.measurements, {".csv"});
    if (!task.surface.empty()) check(surface_task_of(task));
    for (const auto& [key, text] : {std::pair<const char*, const std::string&>("sections", task.sections),
                                    std::pair<const char*, const std::string&>("axis", task.axis)})
        if (task.metrics.empty() && !text.empty())
            throw UsageError(sentence(name(key), " is '", text, "' but ", name("metrics"),
                                      " is not given; expected both, since ", key, key[0] == 's' ? " are" : " is",
                                      " for the measures"));
    try {
        static_cast<void>(sections_of(task, {}));
        static_cast<void>(stated_axis(task.axis, name("axis")));
    } catch (const Error& error) {
        throw UsageError(error.what());
    }
}

void check(const ExportTask& task, const AnnotationView& annotation)
{
    check(task);
    for (const auto& path : {task.mask, task.offset, task.trace, task.mesh, task.metrics, task.measurements})
        check_output_is_not(annotation.volume_path, path);
    if (!task.trace.empty() || !task.mesh.empty()) expect_trace(annotation);
    if (!task.measurements.empty() && annotation.measurements.empty())
        fail(option_name(task.names, "measurements"), " is '", task.measurements.string(),
             "' but nothing is measured; expected distances, paths or angles from the window's tool Measure");
    static_cast<void>(project_labels(task, annotation.project));
    if (!task.surface.empty()) check(surface_task_of(task), annotation);
}

ExportResult run(const ExportTask& asked, const AnnotationView& annotation, ProgressReporter& reporter,
                 const std::function<void(const ExportResult& so_far)>& wrote)
{
    check(asked, annotation);
    ExportTask task = asked;
    for (std::filesystem::path* path :
         {&task.mask, &task.offset, &task.trace, &task.mesh, &task.metrics, &task.measurements})
        if (!path->empty()) *path = written_path(*path);
    const TraceSpace space = space_of(annotation.volume);
    ExportResult result = summary_of(annotation);
    const auto note = [&](const std::filesystem::path& path) {
        result.written.push_back(path.string());
        if (wrote) wrote(result);
    };
    const auto begin = [&](const std::filesystem::path& path) { return reporter.begin("writing " + path.string()); };
    if (!task.trace.empty()) {
        static_cast<void>(begin(task.trace));
        const Loops loops = task.break_loops ? Loops::break_open : Loops::refuse;
        result.left_out = save_trace(task.trace, annotation.trace, space, loops, task.space);
        note(task.trace);
    }
    for (const std::filesystem::path& path : {task.mask, project_labels(task, annotation.project)}) {
        if (path.empty()) continue;
        export_mask(path, annotation.mask, annotation.volume,
                    {.colors = label_looks(annotation.groups, annotation.mask),
                     .painted_on = annotation.volume_hash,
                     .header = mask_header(annotation.mask_path)},
                    task.version, begin(path));
        note(path);
    }
    if (!task.offset.empty()) {
        export_offsets(task.offset, annotation.density, annotation.volume, begin(task.offset));
        note(task.offset);
    }
    if (!task.mesh.empty()) {
        static_cast<void>(begin(task.mesh));
        save_trace_mesh(task.mesh, annotation.trace, space, task.space);
        note(task.mesh);
    }
    if (!task.metrics.empty()) {
        const Progress progress = reporter.begin("measuring what is painted");
        const std::string text = metrics_csv(measure(annotation.trace), annotation.mask.voxels_by_group(),
                                             topology_by_group(annotation.mask, progress), space) +
                                 pattern_text(task, annotation, space);
        write_file_atomically(task.metrics, std::as_bytes(std::span(text)));
        note(task.metrics);
    }
    if (!task.surface.empty())
        run(surface_task_of(task), annotation, reporter,
            [&](const SurfaceResult& so_far) { note(so_far.written.back()); });
    if (!task.measurements.empty()) {
        const std::string text = measurements_table(annotation.measurements, space, task.space, ',');
        write_file_atomically(task.measurements, std::as_bytes(std::span(text)));
        note(task.measurements);
    }
    return result;
}

}  // namespace shvr

#include "engine/tasks/surface_task.h"

#include <algorithm>
#include <set>

#include "engine/annotation/meshes/decimated_surfaces.h"
#include "engine/base/text.h"
#include "engine/formats/export/surface_export.h"
#include "engine/projects/import_memory.h"
#include "engine/tasks/task_output.h"
#include "engine/volume/unit.h"

namespace shvr {

namespace {

constexpr int64_t MAX_SURFACE_MIB = int64_t{1} << 24;

std::set<uint8_t> stated_groups(const SurfaceTask& task)
{
    std::set<uint8_t> groups;
    std::string_view rest = task.groups;
    while (!rest.empty()) {
        const size_t end = std::min(rest.find('+'), rest.size());
        const std::optional<int64_t> group = whole_of(rest.substr(0, end));
        if (!group || *group < 1 || *group > 255 || end + 1 == rest.size())
            throw UsageError(sentence(
                option_name(task.names, task.names == OptionNames::command_line ? "surface" : "surface_groups"),
                " names the groups ", in_quotes(task.groups),
                "; expected numbers of groups, 1 to 255, as in 3 or 1+4"));
        groups.insert(uint8_t(*group));
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return groups;
}

std::filesystem::path file_of_group(const std::filesystem::path& path, int group)
{
    return path.parent_path() / (path.stem().string() + "-" + std::to_string(group) + path.extension().string());
}

/// The surfaces of some groups, GroupSurfaces or DecimatedSurfaces, where the volume lies.
template <class Surfaces>
class PlacedSurfaces final : public SurfaceParts {
public:
    PlacedSurfaces(Surfaces& surfaces, const AnnotationView& annotation, Positions positions)
        : surfaces_(surfaces), annotation_(annotation), space_(space_of(annotation.volume)), positions_(positions)
    {
        comments = {"unit " + space_.unit, in_words(space_, positions)};
        for (const auto& [name, value] : statements_of(space_, positions)) comments.push_back(name + (" " + value));
        if (positions == Positions::physical && !space_.frame.empty()) comments.push_back("SPACE=" + space_.frame);
        if (positions == Positions::physical) origin = space_.origin;
        if (const std::optional<double> micrometres = micrometres_in(space_.unit)) metres = 1e-6 * *micrometres;
    }

    void take(const std::vector<uint8_t>& groups)
    {
        parts.clear();
        for (const uint8_t group : groups) {
            const ColorGroup look = group_of(annotation_.groups, group);
            const GroupSurfaces::Size size = surfaces_.size_of(group);
            parts.push_back({.group = group,
                             .name = look.name,
                             .color = look.color,
                             .vertices = size.vertices,
                             .triangles = size.triangles});
        }
    }

    void for_each_vertex(const SurfacePart& part, const VisitVertex& visit, const Progress& progress) override
    {
        surfaces_.for_each_vertex(
            uint8_t(part.group), [&](const glm::dvec3& voxels) { visit(placed(voxels)); }, progress);
    }
    void for_each_triangle(const SurfacePart& part, const VisitTriangle& visit, const Progress& progress) override
    {
        surfaces_.for_each_triangle(
            uint8_t(part.group),
            [&](const glm::uvec3& indices, const std::array<glm::dvec3, 3>& voxels) {
                visit(indices, {placed(voxels[0]), placed(voxels[1]), placed(voxels[2])});
            },
            progress);
    }

private:
    /// Axes are right-handed, so triangles stay counter-clockwise.
    glm::dvec3 placed(const glm::dvec3& voxels) const
    {
        const glm::dvec3 position = voxels * space_.spacing;
        return positions_ == Positions::physical ? physical_of(space_, position) : position;
    }

    Surfaces& surfaces_;
    const AnnotationView& annotation_;
    TraceSpace space_;
    Positions positions_;
};

/// Writes the files, and calls `wrote` after each.
template <class Surfaces>
SurfaceResult write(Surfaces& surfaces, const SurfaceTask& task, const AnnotationView& annotation,
                    const std::vector<uint8_t>& groups, const std::vector<std::filesystem::path>& files,
                    ProgressReporter& reporter, SurfaceResult result,
                    const std::function<void(const SurfaceResult& so_far)>& wrote)
{
    PlacedSurfaces<Surfaces> placed(surfaces, annotation, task.space);
    for (const uint8_t group : groups) result.triangles_by_group[group] = int64_t(surfaces.size_of(group).triangles);
    for (size_t i = 0; i < files.size(); ++i) {
        const std::filesystem::path path = written_path(files[i]);
        placed.take(files.size() == 1 ? groups : std::vector{groups[i]});
        export_surfaces(path, placed, reporter.begin("writing " + path.string()));
        result.written.push_back(path.string());
        if (wrote) wrote(result);
    }
    return result;
}

/// The groups that the task states, or else all that are painted.
std::vector<uint8_t> groups_to_write(const SurfaceTask& task, const Mask& mask)
{
    std::vector<uint8_t> painted;
    std::string names;
    for (size_t group = 1; group < 256; ++group) {
        if (mask.voxels_by_group()[group] == 0) continue;
        painted.push_back(uint8_t(group));
        names += (names.empty() ? "" : ", ") + std::to_string(group);
    }
    if (painted.empty())
        fail(task.surface.string(), ": cannot be written: nothing is painted; expected a painted group, whose surface ",
             "it would hold");
    const std::set<uint8_t> stated = stated_groups(task);
    for (const uint8_t group : stated)
        if (!std::ranges::binary_search(painted, group))
            fail(task.surface.string(), ": cannot be written: group ", int(group),
                 " has no painted voxels, and so no surface; expected one of: ", names);
    return stated.empty() ? painted : std::vector<uint8_t>(stated.begin(), stated.end());
}

}  // namespace

void fields(Fields& f, SurfaceTask& task)
{
    f.path("surface", task.surface,
           {.meaning = "the painted groups as closed surfaces: .stl, one file for each group; .ply, .obj, .glb",
            .standard = "required",
            .is_required = true});
    f.text("groups", task.groups, {.meaning = "groups to write, such as 3 or 1+4", .standard = "all that are painted"});
    surface_form_fields(f, task);
    f.choice("space", task.space, {"where other programs show the volume, or voxel * spacing"});
    f.whole("budget_host_mib", task.budget_host_mib, 0, MAX_SURFACE_MIB,
            {"memory that it may take, in MiB; 0: three quarters of what the process was given"});
}

std::vector<std::filesystem::path> replaced_files(const SurfaceTask& task)
{
    std::vector<std::filesystem::path> found;
    if (task.surface.empty()) return found;
    std::vector<std::filesystem::path> files{task.surface};
    const bool is_one =
        !holds_one_surface(task.surface) || (!task.groups.empty() && task.groups.find('+') == std::string::npos);
    for (int group = 1; group < 256 && !is_one; ++group) files.push_back(file_of_group(task.surface, group));
    for (const std::filesystem::path& path : files) {
        std::error_code ignored;
        if ((is_one || path != task.surface) && std::filesystem::exists(path, ignored)) found.push_back(path);
    }
    return found;
}

void check(const SurfaceTask& task)
{
    static_cast<void>(stated_groups(task));
    if (task.surface.empty())
        throw UsageError(sentence(option_name(task.names, "surface"),
                                  " names no file; expected one that ends in .stl, ", ".ply, .obj or .glb"));
    check_output(option_name(task.names, "surface"), task.surface, surface_extensions());
    if (task.smooth < 0 || task.smooth > MAX_SURFACE_STEPS)
        throw UsageError(sentence(option_name(task.names, "smooth"), " is ", task.smooth, "; expected 0 to ",
                                  MAX_SURFACE_STEPS, " steps"));
    if (!(task.decimate >= MIN_SURFACE_SHARE && task.decimate <= 1.0))
        throw UsageError(sentence(option_name(task.names, "decimate"), " is ", task.decimate, "; expected a share of ",
                                  "the triangles, ", MIN_SURFACE_SHARE, " to 1"));
}

std::vector<std::filesystem::path> surface_files(const SurfaceTask& task, const Mask& mask)
{
    const std::vector<uint8_t> groups = groups_to_write(task, mask);
    if (!holds_one_surface(task.surface) || stated_groups(task).size() == 1) return {task.surface};
    std::vector<std::filesystem::path> files;
    for (const uint8_t group : groups) files.push_back(file_of_group(task.surface, group));
    return files;
}

void check(const SurfaceTask& task, const AnnotationView& annotation)
{
    check(task);
    for (const std::filesystem::path& path : surface_files(task, annotation.mask)) {
        check_output_is_not(annotation.volume_path, path);
        check_output_place(path);
    }
}

SurfaceResult run(const SurfaceTask& task, const AnnotationView& annotation, ProgressReporter& reporter,
                  const std::function<void(const SurfaceResult& so_far)>& wrote)
{
    check(task, annotation);
    const std::vector<uint8_t> groups = groups_to_write(task, annotation.mask);
    const std::vector<std::filesystem::path> files = surface_files(task, annotation.mask);
    GroupSurfaces surfaces(annotation.mask, {.steps = task.smooth,
                                             .spacing = annotation.volume.spacing,
                                             .memory = uint64_t(import_budget(task.budget_host_mib << 20)),
                                             .progress = reporter.begin("making surfaces")});
    if (task.decimate >= 1.0) return write(surfaces, task, annotation, groups, files, reporter, {}, wrote);
    DecimatedSurfaces fewer(surfaces, {.share = task.decimate,
                                       .spacing = annotation.volume.spacing,
                                       .memory = uint64_t(import_budget(task.budget_host_mib << 20)),
                                       .progress = reporter.begin("decimating surfaces")});
    return write(fewer, task, annotation, groups, files, reporter, {.decimation_error = fewer.error()}, wrote);
}

}  // namespace shvr

#include "engine/workbench/forms/export_form.h"

#include <algorithm>

#include "engine/workbench/forms/form_names.h"

namespace shvr::ui {

namespace {

constexpr const char* MASK_ENDINGS[] = {".nrrd", ".tif", ".zarr", ".mask"};
constexpr const char* TRACE_ENDINGS[] = {".graphml", ".swc", ".rsml", ".txt"};
constexpr const char* MEASURES_ENDINGS[] = {".csv"};
constexpr const char* SURFACE_ENDINGS[] = {".ply", ".stl", ".obj", ".glb"};

std::filesystem::path file_of(const std::filesystem::path& base, const char* what, const ExportForm::Part& part)
{
    return base.string() + '-' + what + part.ending;
}

/// .mask and .nrrd hold one byte for each voxel; the other formats compress them.
bool is_compressed(const std::string& mask_ending)
{
    return mask_ending != ".mask" && mask_ending != ".nrrd";
}

double bytes_of_mask(const Model& model)
{
    const Size3& size = model.volume.size;
    return double(size.x) * double(size.y) * double(size.z);
}

std::string size_of_mask(const Model& model, const std::string& ending)
{
    return (is_compressed(ending) ? "at most " : "") + bytes_in_words(bytes_of_mask(model));
}

/// Bytes that a node with its internode takes in a file, measured with traces of random positions.
double bytes_per_node(const std::string& ending)
{
    if (ending == ".graphml") return 420.0;
    if (ending == ".rsml") return 140.0;
    return ending == ".txt" ? 110.0 : 75.0;
}

double bytes_of_trace(const Model& model, const std::string& ending)
{
    constexpr double HEAD = 1000.0;
    return HEAD + bytes_per_node(ending) * double(model.trace.nodes().size());
}

/// What surfaces take if no two voxels touch: twelve triangles and eight vertices each. Usually most faces are inside
/// and not written; only voxels that touch over edges alone, as in a chequered pattern, take more.
double bytes_of_surfaces(const Model& model, const std::string& ending)
{
    constexpr double TRIANGLES = 12.0, VERTICES = 8.0, HEAD = 1500.0;
    double bytes = 50.0 * TRIANGLES;
    if (ending == ".ply") bytes = 14.0 * TRIANGLES + 27.0 * VERTICES;
    if (ending == ".obj") bytes = 35.0 * TRIANGLES + 63.0 * VERTICES;
    if (ending == ".glb") bytes = 12.0 * TRIANGLES + 12.0 * VERTICES;
    double voxels = 0.0;
    for (size_t group = 1; group < model.voxels_by_group.size(); ++group)
        voxels += double(model.voxels_by_group[group]);
    return HEAD + bytes * voxels;
}

bool is_painted(const Model& model)
{
    for (size_t group = 1; group < model.voxels_by_group.size(); ++group)
        if (model.voxels_by_group[group] > 0) return true;
    return false;
}

}  // namespace

std::vector<ExportRow> rows_of(ExportForm& form, const Model& model)
{
    const std::filesystem::path name = placed_new(form.base, {}).filename();
    const bool is_traced = !model.trace.nodes().empty();
    std::vector<ExportRow> rows{
        {"Mask", &form.mask, MASK_ENDINGS, file_of(name, "mask", form.mask).string(),
         size_of_mask(model, form.mask.ending), ""},
        {"Trace", &form.trace, TRACE_ENDINGS, file_of(name, "trace", form.trace).string(),
         is_traced ? "about " + bytes_in_words(bytes_of_trace(model, form.trace.ending)) : "",
         is_traced ? "" : "nothing is traced yet"},
        {"Measures", &form.measures, MEASURES_ENDINGS, file_of(name, "measures", form.measures).string(), "", ""},
        {"Surfaces", &form.surfaces, SURFACE_ENDINGS,
         file_of(name, form.surfaces.ending == ".stl" ? "surface-N" : "surface", form.surfaces).string(),
         is_painted(model) ? "usually below " + bytes_in_words(bytes_of_surfaces(model, form.surfaces.ending)) : "",
         is_painted(model) ? "" : "nothing is painted yet"}};
    if (!model.measurements.empty())
        rows.push_back({"Distances, angles", &form.measurements, MEASURES_ENDINGS,
                        file_of(name, "distances", form.measurements).string(), "", ""});
    return rows;
}

ExportForm suggested_export(const Model& model, const ExportForm& last)
{
    ExportForm form = last;
    const bool is_traced = !model.trace.nodes().empty();
    form.base = base_of(model).string();
    form.mask.is_written = is_painted(model);
    form.trace.is_written = is_traced;
    form.surfaces.is_written = false;
    form.measures.is_written = form.mask.is_written || is_traced;
    form.measurements.is_written = !model.measurements.empty();
    if (!form.measures.is_written && !form.measurements.is_written) form.mask.is_written = true;
    return form;
}

ExportTask task_of(const ExportForm& form, const std::filesystem::path& folder)
{
    ExportTask task = form.more;
    const std::filesystem::path base = placed_new(form.base, folder);
    task.mask = task.trace = task.metrics = task.surface = task.measurements = std::filesystem::path();
    for (std::filesystem::path* const more : {&task.offset, &task.mesh})
        *more = placed_new(more->string(), base.parent_path());
    if (base.empty() || !base.has_filename()) return task;
    if (form.mask.is_written) task.mask = file_of(base, "mask", form.mask);
    if (form.trace.is_written) task.trace = file_of(base, "trace", form.trace);
    if (form.measures.is_written) task.metrics = file_of(base, "measures", form.measures);
    if (form.surfaces.is_written) task.surface = file_of(base, "surface", form.surfaces);
    if (form.measurements.is_written) task.measurements = file_of(base, "distances", form.measurements);
    return task;
}

BytesNeeded bytes_written(const ExportForm& form, const Model& model)
{
    BytesNeeded needed;
    if (form.mask.is_written) {
        needed.most = bytes_of_mask(model);
        if (!is_compressed(form.mask.ending)) needed.least = needed.most;
    }
    if (form.trace.is_written && !model.trace.nodes().empty()) needed.most += bytes_of_trace(model, form.trace.ending);
    if (form.surfaces.is_written && is_painted(model)) needed.most += bytes_of_surfaces(model, form.surfaces.ending);
    return needed;
}

int64_t files_of_surfaces(const ExportForm& form, const Model& model)
{
    if (form.surfaces.ending != ".stl") return 1;
    if (!form.more.surface_groups.empty()) return 1 + std::ranges::count(form.more.surface_groups, '+');
    return std::ranges::count_if(model.voxels_by_group.begin() + 1, model.voxels_by_group.end(),
                                 [](int64_t voxels) { return voxels > 0; });
}

}  // namespace shvr::ui

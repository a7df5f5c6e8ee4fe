#include "engine/workbench/forms/import_form.h"

#include <algorithm>
#include <utility>

#include "engine/base/text.h"
#include "engine/remote/address.h"
#include "engine/workbench/forms/form_names.h"
#include "engine/workbench/forms/voxel_size.h"

namespace shvr::ui {

ImportForm suggested_import(const Model& model, const std::filesystem::path& volume)
{
    ImportForm form;
    if (!volume.empty())
        form.volume = volume.string();
    else if (model.is_open)
        form.volume = model.session.volume_path.string();
    follow_volume(form);
    const bool is_given = model.volume.spacing_from == Provenance::given || model.volume.unit_from == Provenance::given;
    if (model.is_open && !form.volume.empty() && form.volume == model.session.volume_path.string() && is_given)
        form.voxel_size = form.suggested_size = text_of(VoxelSize{model.volume.spacing, model.volume.unit});
    return form;
}

std::filesystem::path project_for(const std::filesystem::path& volume)
{
    if (volume.empty() || leads_to_network(volume)) return {};
    const std::filesystem::path stem = stem_of(volume);
    return stem.has_filename() ? std::filesystem::path(stem.string() + "-project") : std::filesystem::path();
}

void follow_volume(ImportForm& form)
{
    if (form.voxel_size == form.suggested_size) form.voxel_size.clear();
    form.suggested_size.clear();
    if (form.project != form.suggested) return;
    form.project = form.suggested = project_for(form.volume).string();
}

std::string why_not(const ImportForm& form)
{
    if (form.volume.empty()) return "name the scan: a file, a folder of slices, or an address";
    if (trimmed(form.project).empty()) return "name the folder of the project";
    if (form.voxel_size.empty()) return {};
    if (!voxel_size_of(form.voxel_size)) return "'" + form.voxel_size + "' is no size; " + EXPECTED_VOXEL_SIZE;
    return why_no_voxel_size(form.voxel_size);
}

std::string words_of_replacement(const ImportTask& task, const ImportPlace& place)
{
    if (!task.overwrite || !place.is_project || !place.why_not.empty()) return {};
    const std::filesystem::path& path = task.project;
    const std::string name = (path.has_filename() ? path : path.parent_path()).filename().string();
    if (place.annotation.empty()) return name + " exists and will be replaced. It holds no annotation.";
    return sentence(name, " exists and will be deleted, with its annotation: ", place.annotation,
                    ". Undo does not bring that back.");
}

std::string words_of_annotation(const ImportForm& form, const Model& model)
{
    const std::filesystem::path folder = base_of(model).parent_path();
    if (!model.is_open || placed(form.volume, folder) != model.session.volume_path) return {};
    const bool is_painted = std::any_of(model.voxels_by_group.begin() + 1, model.voxels_by_group.end(),
                                        [](int64_t voxels) { return voxels > 0; });
    const bool is_traced = !model.trace.nodes().empty();
    if (!is_painted && !is_traced) return {};
    std::string files;
    for (const auto& [is_made, path] :
         {std::pair(is_painted, &model.session.mask_path), std::pair(is_traced, &model.session.trace_path)})
        if (is_made && !path->empty())
            files += (files.empty() ? "" : " and ") + path->lexically_proximate(folder).string();
    const std::string begins = "The project begins without the annotation of this scan, which stays with the scan";
    if (form.more.downscale > 1 || form.more.crop) return begins + ": it fits the whole scan alone.";
    return begins + ". Load annotation brings it into the project" +
           (files.empty() ? std::string(".") : ", from " + files + ".");
}

BytesNeeded bytes_written(const ImportEstimate& estimate)
{
    constexpr double LEAST = 3000.0;  // metadata and tables of the smallest project
    return {LEAST, std::max(LEAST, estimate.most_bytes)};
}

ImportTask task_of(const ImportForm& form, const std::filesystem::path& folder)
{
    ImportTask task = form.more;
    task.volume = leads_to_network(form.volume) ? std::filesystem::path(form.volume) : placed(form.volume, folder);
    const std::filesystem::path beside = leads_to_network(task.volume) ? folder : task.volume.parent_path();
    task.project = placed_new(form.project, beside);
    if (const std::optional<VoxelSize> size = voxel_size_of(form.voxel_size)) {
        task.choice.spacing = size->spacing;
        task.choice.unit = size->unit;
    }
    return task;
}

}  // namespace shvr::ui

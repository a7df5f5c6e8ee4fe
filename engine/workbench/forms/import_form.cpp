#include "engine/workbench/forms/import_form.h"

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
    if (form.project != form.suggested) return;
    form.project = form.suggested = project_for(form.volume).string();
}

std::string why_not(const ImportForm& form)
{
    if (form.volume.empty()) return "name the scan: a file, a folder of slices, or an address";
    if (form.project.empty()) return "name the folder of the project";
    if (form.voxel_size.empty() || voxel_size_of(form.voxel_size)) return {};
    return "'" + form.voxel_size + "' is no size; " + EXPECTED_VOXEL_SIZE;
}

ImportTask task_of(const ImportForm& form, const std::filesystem::path& folder)
{
    ImportTask task = form.more;
    task.volume = leads_to_network(form.volume) ? std::filesystem::path(form.volume) : placed(form.volume, folder);
    const std::filesystem::path beside = leads_to_network(task.volume) ? folder : task.volume.parent_path();
    task.project = placed(form.project, beside);
    if (const std::optional<VoxelSize> size = voxel_size_of(form.voxel_size)) {
        task.choice.spacing = size->spacing;
        task.choice.unit = size->unit;
    }
    return task;
}

}  // namespace shvr::ui

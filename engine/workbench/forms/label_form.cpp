#include "engine/workbench/forms/label_form.h"

#include "engine/base/text.h"
#include "engine/workbench/forms/form_names.h"
#include "engine/workbench/forms/operation_form.h"

namespace shvr::ui {

namespace {

double voxels_of(const Model& model)
{
    const Size3& size = model.volume.size;
    return double(size.x) * double(size.y) * double(size.z);
}

double most_bytes(const LabelForm& form, const Model& model)
{
    constexpr double MAX_LABEL_BYTES = 4.0;
    const bool has_bytes = form.more.largest > 0 && form.more.largest <= 255;
    return voxels_of(model) * (has_bytes ? 1.0 : MAX_LABEL_BYTES);
}

}  // namespace

LabelForm suggested_label(const Model& model)
{
    LabelForm form;
    const std::filesystem::path base = base_of(model);
    if (!base.empty()) form.output = base.string() + "-parts.zarr";
    form.more.threshold = suggested_intensity(model.paint_threshold(), model.volume.type);
    return form;
}

std::string why_not(const LabelForm& form)
{
    if (form.more.fewest_voxels < 1)
        return sentence("the smallest part has ", form.more.fewest_voxels, " voxels; expected 1 or more");
    if (form.writes_labels && trimmed(form.output).empty()) return "name the file of the labels";
    return {};
}

LabelTask task_of(const LabelForm& form, const std::filesystem::path& folder)
{
    LabelTask task = form.more;
    task.output = form.writes_labels ? placed_new(form.output, folder) : std::filesystem::path();
    return task;
}

std::string size_of_labels(const LabelForm& form, const Model& model)
{
    return "at most " + bytes_in_words(most_bytes(form, model));
}

/// A mask has one byte for each voxel; the other formats may compress.
BytesNeeded bytes_written(const LabelForm& form, const Model& model)
{
    if (!form.writes_labels) return {};
    const double most = most_bytes(form, model);
    return {trimmed(form.output).ends_with(".mask") ? voxels_of(model) : 0.0, most};
}

}  // namespace shvr::ui

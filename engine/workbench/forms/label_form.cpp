#include "engine/workbench/forms/label_form.h"

#include "engine/workbench/forms/form_names.h"
#include "engine/workbench/forms/operation_form.h"

namespace shvr::ui {

LabelForm suggested_label(const Model& model)
{
    LabelForm form;
    const std::filesystem::path base = base_of(model);
    if (!base.empty()) form.output = base.string() + "-parts.zarr";
    form.more.threshold = suggested_intensity(model.paint_threshold(), model.volume.type);
    return form;
}

LabelTask task_of(const LabelForm& form, const std::filesystem::path& folder)
{
    LabelTask task = form.more;
    task.output = form.writes_labels ? placed(form.output, folder) : std::filesystem::path();
    return task;
}

std::string size_of_labels(const LabelForm& form, const Model& model)
{
    constexpr double MAX_LABEL_BYTES = 4.0;
    const Size3& size = model.volume.size;
    const double voxels = double(size.x) * double(size.y) * double(size.z);
    const bool has_bytes = form.more.largest > 0 && form.more.largest <= 255;
    return "at most " + bytes_in_words(voxels * (has_bytes ? 1.0 : MAX_LABEL_BYTES));
}

}  // namespace shvr::ui

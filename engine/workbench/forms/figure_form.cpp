#include "engine/workbench/forms/figure_form.h"

#include <cmath>

#include "engine/base/text.h"
#include "engine/tasks/task_output.h"
#include "engine/workbench/forms/form_names.h"

namespace shvr::ui {

namespace {

/// Returns height / width of the window's picture.
double shape_of(const Model& model)
{
    glm::dvec2 pixels(0.0);
    for (const Screen::Part& part : model.panes) pixels = glm::max(pixels, glm::dvec2(part.pane.box.end));
    return pixels.x > 0.0 && pixels.y > 0.0 ? pixels.y / pixels.x : 0.75;
}

}  // namespace

glm::ivec2 pixels_of(const SizeForm& form)
{
    const bool is_printable = form.dots_per_inch >= MIN_PRINT_DPI && form.dots_per_inch <= MAX_PRINT_DPI;
    if (form.is_in_mm && !is_printable) return glm::ivec2(0);
    return pixels_of_print({form.width, form.height}, form.is_in_mm ? form.dots_per_inch : MM_PER_INCH);
}

void change_unit(SizeForm& form, bool is_in_mm)
{
    if (form.is_in_mm == is_in_mm || form.dots_per_inch <= 0.0) return;
    const double factor = is_in_mm ? MM_PER_INCH / form.dots_per_inch : form.dots_per_inch / MM_PER_INCH;
    const double parts = is_in_mm ? 10.0 : 1.0;
    form.width = std::round(form.width * factor * parts) / parts;
    form.height = std::round(form.height * factor * parts) / parts;
    form.is_in_mm = is_in_mm;
}

FigureForm suggested_figure(const Model& model, const FigureForm& last)
{
    FigureForm form = last;
    const std::string ending = std::filesystem::path(last.path).extension().string();
    form.path = base_of(model).string() + "-figure" + (ending.empty() ? ".png" : ending);
    if (pixels_of(form.size) == glm::ivec2(0)) form.size = SizeForm();
    form.size.height = std::round(form.size.width * shape_of(model));
    form.elements = suggested_elements(model, last.elements);
    return form;
}

ElementsForm suggested_elements(const Model& model, const ElementsForm& last)
{
    ElementsForm form = last;
    if (form.scan != model.session.volume_path) {
        form.drawn.title.clear();
        form.drawn.texts.clear();
        form.next_text.clear();
    }
    form.scan = model.session.volume_path;
    form.probe_voxel = model.probe_voxel;
    return form;
}

void add_text(ElementsForm& form)
{
    if (trimmed(form.next_text).empty() || form.drawn.texts.size() >= MAX_FIGURE_TEXTS) return;
    form.drawn.texts.push_back({form.probe_voxel, form.next_text});
    form.next_text.clear();
}

DrawnElements elements_of(const ElementsForm& form)
{
    ElementsForm complete = form;
    add_text(complete);
    return complete.drawn;
}

std::string why_not(const FigureForm& form)
{
    if (pixels_of(form.size) != glm::ivec2(0)) return {};
    return sentence("the size is ", form.size.width, " x ", form.size.height, form.size.is_in_mm ? " mm" : " pixels",
                    form.size.is_in_mm ? sentence(" at ", form.size.dots_per_inch, " dots per inch") : std::string(),
                    "; expected 1 to ", MAX_IMAGE_SIDE, " pixels along each side, and ", MIN_PRINT_DPI, " to ",
                    MAX_PRINT_DPI, " dots per inch");
}

FigureTask task_of(const FigureForm& form, const std::filesystem::path& folder)
{
    FigureTask task = form.more;
    task.elements = elements_of(form.elements);
    task.path = placed_new(form.path, folder);
    task.pixels = pixels_of(form.size);
    task.dots_per_inch = form.size.is_in_mm ? form.size.dots_per_inch : 0.0;
    return task;
}

void check(const FigureTask& task)
{
    if (!task.is_copied) check_output_place(task.path);
}

std::vector<std::filesystem::path> replaced_files(const FigureTask& task)
{
    std::error_code ignored;
    if (task.is_copied || !std::filesystem::exists(task.path, ignored)) return {};
    return {task.path};
}

}  // namespace shvr::ui

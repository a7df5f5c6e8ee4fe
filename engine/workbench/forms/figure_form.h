#pragma once
// The dialog Figure: the file, the size on paper or in pixels, and what is drawn over the picture. Pure, except for
// check and replaced_files, which read the disk; any thread.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/workbench/actions/picture_actions.h"
#include "engine/workbench/models/model.h"
#include "engine/workbench/sight/figure_elements.h"
#include "engine/workbench/sight/print_size.h"

namespace shvr::ui {

/// A size as typed.
struct SizeForm {
    double width = 85.0, height = 64.0;
    bool is_in_mm = true;
    double dots_per_inch = PRINT_DPI;
};
/// Returns 0, 0 for a size that no picture can have.
glm::ivec2 pixels_of(const SizeForm& form);
/// Changes the unit and keeps the pixels.
void change_unit(SizeForm& form, bool is_in_mm);

/// What is drawn over a figure, or over each frame of a movie.
struct ElementsForm {
    DrawnElements drawn;
    std::string next_text;        ///< typed, not yet among the texts
    glm::dvec3 probe_voxel{0.0};  ///< where the next text is put
    std::filesystem::path scan;   ///< to which title and texts belong
};
/// Returns the choices of `last`, its words only if they are of the open scan, with the probe of the present view.
ElementsForm suggested_elements(const Model& model, const ElementsForm& last);
/// Adds the typed text, at the probe, to those that are drawn.
void add_text(ElementsForm& form);
/// Returns what is drawn. A text that was typed is meant, also without Add.
DrawnElements elements_of(const ElementsForm& form);

struct FigureForm {
    std::string path;  ///< as typed
    SizeForm size;
    FigureTask more;  ///< what has no field of its own here
    ElementsForm elements{.drawn = {.has_scale_bar = true}};
};

/// Returns a form for the present view, with a name next to the scan, and the picture's shape. `last`: choices to use
/// again, except a size that no picture can have.
FigureForm suggested_figure(const Model& model, const FigureForm& last);
std::string why_not(const FigureForm& form);
/// `folder`: where relative names lie.
FigureTask task_of(const FigureForm& form, const std::filesystem::path& folder);
/// Fails if the figure cannot be written there.
void check(const FigureTask& task);
std::vector<std::filesystem::path> replaced_files(const FigureTask& task);

}  // namespace shvr::ui

#pragma once
// Lines and labels that the window draws over a pane: the brush's ring and the trace in slices, the link that a new
// node would get, distances, a scale bar, directions of the axes, the groups, and the pane's title. On request, they
// are also drawn into picture files, except for those that only guide the hand (figure.h). Pure; main thread only,
// while the model exists.

#include <span>
#include <string>
#include <vector>

#include "engine/look/overlay.h"
#include "engine/workbench/models/model.h"
#include "engine/workbench/sight/label_place.h"

namespace shvr::ui {

/// Font size in pixels, if a unit of the interface has one pixel.
inline constexpr double FONT_UNITS = 14.0;
/// Kept free around a text, in units of the interface.
inline constexpr glm::dvec2 LABEL_MARGIN{3.0, 1.0};

struct Label {
    glm::dvec2 at{0.0};      ///< pixels of the pane
    glm::dvec2 anchor{0.0};  ///< point of the text that is placed at `at`; 0, 0: upper left corner; 1, 1: lower right
    std::string text;
    glm::dvec3 color{1.0};  ///< linear light
    glm::dvec2 away{0.0};   ///< as in LabelPlace
    size_t key = 0;         ///< identifies what it names in each frame; 0: none
};
/// Whether dark ink stands out at a pixel of a pane: on a light background, and not over the scan in a slice, whose air
/// is dark. Transparent backgrounds count as light: they are put on paper.
bool is_light_at(const glm::dvec2& pixel, const Pane& pane, const VolumeInfo& volume, const glm::dvec4& background);
/// Texts over pictures have a rim, so that they can be read on any picture: dark around a light ink, else light. Its
/// width in pixels, for a font of this height.
glm::dvec3 rim_color(const glm::dvec3& ink);
double rim_width(double font_pixels);
struct Marks {
    std::vector<Stroke> strokes;
    std::vector<Label> labels;
    std::vector<LabelLine> lines;  ///< those of the strokes that labels avoid
};
/// Moves labels apart and off lines (label_place.h), and draws a thin line to each that is far from its point.
/// `text_sizes`: of the labels' texts; `margin`: around each; both in pixels. `memory`: where labels with keys were in
/// the last frame, so that they stay there while the view turns; renewed. Null: none.
void spread_labels(Marks& marks, std::span<const glm::dvec2> text_sizes, const glm::dvec2& margin,
                   const glm::dvec2& pane, LabelMemory* memory = nullptr);

enum class MarksFor { screen, picture };

/// `pane`: as displayed. `index`: the pane's number. `units`: pixels per unit of the interface, such as 2 on HiDPI.
Marks marks_of(const Model& model, const Pane& pane, size_t index, double units = 1.0,
               MarksFor purpose = MarksFor::screen);

}  // namespace shvr::ui

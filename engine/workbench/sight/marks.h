#pragma once
// Lines and words that the window draws over a pane: the brush's ring and the trace in slices, the link that a new node
// would get, distances, a scale bar, directions of the axes, the groups, and what the pane shows. Pictures in files
// have those that are no help for the hand, where that is wanted (figure.h). Pure; the main thread, while the model
// lives.

#include <string>
#include <vector>

#include "engine/look/overlay.h"
#include "engine/workbench/models/model.h"

namespace shvr::ui {

/// Size of the font where a unit of the interface is a pixel.
inline constexpr double FONT_UNITS = 14.0;

struct Label {
    glm::dvec2 at{0.0};      ///< pixels of the pane
    glm::dvec2 anchor{0.0};  ///< which part of the text is there: 0, 0 its upper left corner, 1, 1 its lower right one
    std::string text;
    glm::dvec3 color{1.0};  ///< linear light
};
struct Marks {
    std::vector<Stroke> strokes;
    std::vector<Label> labels;
};

enum class MarksFor { screen, picture };

/// `pane`: as it is shown; `index`: its number. `units`: pixels of one unit of the interface, 2 on a HiDPI screen.
Marks marks_of(const Model& model, const Pane& pane, size_t index, double units = 1.0,
               MarksFor purpose = MarksFor::screen);

}  // namespace shvr::ui

#pragma once
// Elements that publications need over a picture: scale bar, colour bar, legend of the groups, title, measurements,
// texts at points and the directions of the axes. Drawn without boxes, in black or white, whichever stands out from
// what is behind (is_light_at), with a thin rim in the other. Pure; any thread, except for the drawer of texts.

#include <span>
#include <string>
#include <vector>

#include "engine/session/session.h"
#include "engine/workbench/actions/picture_actions.h"
#include "engine/workbench/sight/figure.h"
#include "engine/workbench/sight/label_place.h"

namespace shvr::ui {

/// Returns 1/28 of the shorter side of a picture or its first pane, at least 10.
double automatic_text_pixels(const glm::uvec2& size);

/// Where labels were in the last frame of a movie, so that they stay there while the view turns; one per pane.
using FigureMemory = std::vector<LabelMemory>;

/// The inputs of a figure. `groups`: the groups that are drawn (drawn_groups). `memory`: renewed by each frame of a
/// movie; null: the figure is no frame.
struct FigureScene {
    const Session& session;
    const VolumeInfo& volume;
    std::span<const Pane> panes;
    std::span<const uint8_t> groups;
    FigureMemory* memory = nullptr;
};
/// Title, legend, colour bar, texts and axes are drawn in the first pane. No element is drawn over another, except for
/// texts with no free place near their points, and the lines of measurements. Line ends in title and texts begin new
/// lines. `left_out`: receives a sentence for each element that is left out or shortened, with the reason.
Figure figure_of(const DrawnElements& elements, const FigureScene& scene, const TextDrawer& draw_texts,
                 std::vector<std::string>& left_out);

}  // namespace shvr::ui

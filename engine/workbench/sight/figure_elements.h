#pragma once
// Elements that publications need over a picture: scale bar, colour bar, legend of the groups, title, measurements,
// texts at points and the directions of the axes. Drawn without boxes, in black or white, whichever stands out from the
// background, with a thin rim in the other. Pure; any thread, except for the drawer of texts.

#include <span>
#include <string>
#include <vector>

#include "engine/session/session.h"
#include "engine/workbench/sight/figure.h"
#include "engine/workbench/sight/label_place.h"

namespace shvr::ui {

/// A text at a point of the volume, and a dot there.
struct FigureText {
    glm::dvec3 voxel{0.0};
    std::string text;
};

struct FigureElements {
    bool scale_bar = false;  ///< in each view and slice: a line of a rounded length. In perspective its label names the
                             ///< plane in which it holds
    bool color_bar = false;  ///< colours of the transfer function, and its opacity relative to its maximum
    bool legend = false;     ///< colours and names of the groups that are drawn
    bool axes = false;       ///< directions of x, y and z
    bool measurements = false;  ///< in each view and slice: lines, names and values of the session's measurements
    std::string title;
    std::vector<FigureText> texts;
    double text_pixels = 0.0;  ///< height of a line of text; 0: automatic_text_pixels()
    bool is_empty() const
    {
        return !scale_bar && !color_bar && !legend && !axes && !measurements && title.empty() && texts.empty();
    }
};

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
Figure figure_of(const FigureElements& elements, const FigureScene& scene, const TextDrawer& draw_texts,
                 std::vector<std::string>& left_out);

}  // namespace shvr::ui

#pragma once
// Scale bar, axes, distances and pane titles, as drawn into picture files (marks.h). Pure; the main thread builds a
// figure while the model exists, and any thread may draw it.

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "engine/look/stamps.h"
#include "engine/workbench/sight/marks.h"

namespace shvr::ui {

/// A line of text as the coverage of each pixel; the image's height is the line height.
struct TextImage {
    glm::ivec2 pixels{0};
    std::vector<uint8_t> coverage;
};
/// Draws texts, all with the same height in pixels. Main thread only.
using TextDrawer = std::function<std::vector<TextImage>(std::span<const std::string> texts, double pixels)>;

struct Figure {
    struct Part {
        PixelBox box;  ///< box of the pane within the whole picture
        std::vector<Stroke> strokes;
        std::vector<Stamp> stamps;
    };
    std::vector<Part> parts;
};

/// Builds the figure. `units`: pixels per unit of the interface, times the picture's scale. Without a drawer of texts,
/// the figure has no labels.
Figure figure_of(const Model& model, std::span<const Pane> panes, double units, const TextDrawer& draw_texts);
/// Draws the figure over `rows`, the part of the picture that starts at `first_row`.
void draw(const Figure& figure, ImageF& rows, uint32_t first_row);
void draw(const Figure& figure, Image8& picture);

}  // namespace shvr::ui

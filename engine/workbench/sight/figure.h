#pragma once
// Scale bar, axes, distances and pane titles (marks.h), as drawn into picture files. Pure. The main thread builds a
// figure while the model exists; any thread may draw the figure.

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "engine/look/stamps.h"
#include "engine/workbench/sight/marks.h"

namespace shvr::ui {

/// A line of text as an image whose pixels state the coverage by text; its height is the height of a line.
struct TextImage {
    glm::ivec2 pixels{0};
    std::vector<uint8_t> coverage;
};
/// A function that draws texts into images, all with the same height in pixels. Main thread only.
using TextDrawer = std::function<std::vector<TextImage>(std::span<const std::string> texts, double pixels)>;

struct Figure {
    struct Part {
        PixelBox box;  ///< the pane's box within the whole picture
        std::vector<Stroke> strokes;
        std::vector<Stamp> stamps;
    };
    std::vector<Part> parts;
};

/// Builds the figure. `units`: pixels of the picture per unit of the interface. If `draw_texts` is null, the figure has
/// no labels.
Figure figure_of(const Model& model, std::span<const Pane> panes, double units, const TextDrawer& draw_texts);
/// Draws the figure over `rows`, a band of the picture whose first row is `first_row`.
void draw(const Figure& figure, ImageF& rows, uint32_t first_row);
void draw(const Figure& figure, Image8& picture);

}  // namespace shvr::ui

#pragma once
// Scale bar, axes, distances and what a pane shows, as they are drawn into pictures in files (marks.h). Pure; the main
// thread makes one while the model lives, any thread draws it.

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "engine/look/stamps.h"
#include "engine/workbench/sight/marks.h"

namespace shvr::ui {

/// A line of text as a coverage of pixels, whose height is that of a line.
struct TextImage {
    glm::ivec2 pixels{0};
    std::vector<uint8_t> coverage;
};
/// Draws texts of one height in pixels. The main thread.
using TextDrawer = std::function<std::vector<TextImage>(std::span<const std::string> texts, double pixels)>;

struct Figure {
    struct Part {
        PixelBox box;  ///< of the pane, in the whole picture
        std::vector<Stroke> strokes;
        std::vector<Stamp> stamps;
    };
    std::vector<Part> parts;
};

/// `units`: pixels of one unit of the interface: of its scale and of the picture's. Without a drawer there are no
/// words.
Figure figure_of(const Model& model, std::span<const Pane> panes, double units, const TextDrawer& draw_texts);
/// `rows`: of the picture, from `first_row` on.
void draw(const Figure& figure, ImageF& rows, uint32_t first_row);
void draw(const Figure& figure, Image8& picture);

}  // namespace shvr::ui

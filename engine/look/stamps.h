#pragma once
// Single-colour shapes over a picture: text rasterized by the caller, and its background. Complements the lines of
// overlay.h. Pure; any thread.

#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/image.h"
#include "engine/look/camera_motion.h"

namespace shvr {

struct Stamp {
    glm::ivec2 begin{0};            ///< its upper left pixel, in its pane; may lie outside
    glm::ivec2 pixels{0};           ///< width and height
    std::vector<uint8_t> coverage;  ///< rows from the top; 255: the pixel takes the colour
    glm::dvec3 color{1.0};          ///< linear light
};

/// Draws stamps in order over premultiplied light. Stamps lie relative to `pane`, a box of pixels of the picture, and
/// are clipped to it. `image` holds some or all of the picture's rows, starting at `first_row`.
void draw_stamps(ImageF& image, std::span<const Stamp> stamps, const PixelBox& pane, uint32_t first_row = 0);
/// Draws stamps over a screen's opaque pixels, in the same way.
void draw_stamps(Image8& image, std::span<const Stamp> stamps, const PixelBox& pane);

}  // namespace shvr

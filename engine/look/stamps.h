#pragma once
// Shapes of a single colour over a picture: text rasterized by the caller, and its rim. They complement the lines of
// overlay.h. Pure functions; any thread.

#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/image.h"
#include "engine/look/camera_motion.h"

namespace shvr {

struct Stamp {
    glm::ivec2 begin{0};            ///< the stamp's upper left corner in the pane; may be outside the pane
    glm::ivec2 pixels{0};           ///< width and height
    std::vector<uint8_t> coverage;  ///< row by row from the top; 255: fully the stamp's colour
    glm::dvec3 color{1.0};          ///< linear light
};

/// Returns what surrounds a stamp by some pixels, in another colour. Drawn before it, it makes a text readable on any
/// picture.
Stamp rim_of(const Stamp& ink, int width, const glm::dvec3& color);

/// Draws stamps, in order, over premultiplied light. Their positions are relative to `pane`, a box of pixels of the
/// picture, to which they are clipped. `image` holds some or all rows of the picture, from `first_row` on.
void draw_stamps(ImageF& image, std::span<const Stamp> stamps, const PixelBox& pane, uint32_t first_row = 0);
/// Likewise, but over a screen's opaque pixels.
void draw_stamps(Image8& image, std::span<const Stamp> stamps, const PixelBox& pane);

}  // namespace shvr

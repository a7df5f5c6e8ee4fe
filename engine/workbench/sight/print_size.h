#pragma once
// Sizes of printed pictures. Pure; any thread.

#include <cmath>

#include <glm/glm.hpp>

#include "engine/base/image_file.h"

namespace shvr {

inline constexpr double MM_PER_INCH = 25.4;
inline constexpr double PRINT_DPI = 300.0;  ///< what journals ask for
inline constexpr double MIN_PRINT_DPI = 10.0, MAX_PRINT_DPI = 10'000.0;

/// Returns the pixels of a print of that size in millimetres; 0, 0 if a side has none or more than MAX_IMAGE_SIDE.
inline glm::uvec2 pixels_of_print(const glm::dvec2& mm, double dots_per_inch)
{
    const glm::dvec2 pixels = glm::round(mm * dots_per_inch / MM_PER_INCH);
    const auto is_side = [](double side) { return side >= 1.0 && side <= double(MAX_IMAGE_SIDE); };
    return is_side(pixels.x) && is_side(pixels.y) ? glm::uvec2(pixels) : glm::uvec2(0);
}

}  // namespace shvr

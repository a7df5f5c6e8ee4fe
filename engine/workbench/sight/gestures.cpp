#include "engine/workbench/sight/gestures.h"

#include <algorithm>
#include <cmath>

namespace shvr::ui {

bool is_jump(const glm::dvec2& way_pixels, const glm::uvec2& pane_pixels)
{
    constexpr double SHARE = 0.25, MIN_PIXELS = 64.0;
    return glm::length(way_pixels) > std::max(SHARE * double(pane_pixels.y), MIN_PIXELS);
}

ValueRange dragged_contrast(const ValueRange& contrast, const ValueRange& range, const glm::dvec2& heights)
{
    const double whole = std::max(range.upper - range.lower, 1e-300);
    const double width =
        std::clamp((contrast.upper - contrast.lower) * std::pow(16.0, heights.x), 1e-3 * whole, 4.0 * whole);
    const double middle = std::clamp(0.5 * (contrast.lower + contrast.upper) + heights.y * width, range.lower - whole,
                                     range.upper + whole);
    return {middle - 0.5 * width, middle + 0.5 * width};
}

double threshold_at(double value, double least_drawn)
{
    return value > least_drawn ? 0.5 * (value + least_drawn) : value;
}

}  // namespace shvr::ui

#include "tests/reference/transfer.h"

#include <algorithm>
#include <cmath>

namespace shvr::reference {

glm::dvec4 TransferPiece::at(double density) const
{
    const double share = x1 > x0 ? std::clamp((density - x0) / (x1 - x0), 0.0, 1.0) : 0.0;
    return value0 + (value1 - value0) * share;
}

Transfer::Transfer(std::vector<ControlPoint> points) : points_(std::move(points))
{
    std::stable_sort(points_.begin(), points_.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
    if (points_.size() < 2) return;
    for (const ControlPoint& point : points_) {
        if (knots_.empty() || point.x > knots_.back()) knots_.push_back(point.x);
    }
}

TransferPiece Transfer::piece_at(double density) const
{
    if (knots_.empty() || !(density >= knots_.front() && density <= knots_.back())) return {};
    const auto above = std::upper_bound(points_.begin(), points_.end(), density,
                                        [](double value, const ControlPoint& point) { return value < point.x; });
    const ControlPoint& low = *(above - 1);
    const ControlPoint& high = above == points_.end() ? low : *above;
    return {low.x, high.x, glm::dvec4(low.color, low.opacity), glm::dvec4(high.color, high.opacity)};
}

double Transfer::snapped(double density) const
{
    const auto above = std::lower_bound(knots_.begin(), knots_.end(), density);
    if (above != knots_.end() && *above - density <= 1e-14) return *above;
    if (above != knots_.begin() && density - *(above - 1) <= 1e-14) return *(above - 1);
    return density;
}

double opacity_of_length(double opacity, double length)
{
    return -std::expm1(length * std::log1p(-opacity));
}

}  // namespace shvr::reference

#include "tests/reference/cubic.h"

#include <algorithm>
#include <cmath>

namespace shvr::reference {

namespace {

// The cubic is monotone on [low, high] and the level lies strictly between its values at the ends.
double crossing(const Cubic& cubic, double low, double high, double level)
{
    const bool rises = cubic.at(low) < level;
    while (true) {
        const double middle = 0.5 * (low + high);
        if (middle <= low || middle >= high) return middle;
        ((cubic.at(middle) < level) == rises ? low : high) = middle;
    }
}

}  // namespace

double Cubic::at(double t) const
{
    const auto blend = [t](double a, double b) { return a + (b - a) * t; };
    const std::array<double, 4>& b = bernstein;
    const double left = blend(b[0], b[1]), middle = blend(b[1], b[2]), right = blend(b[2], b[3]);
    return blend(blend(left, middle), blend(middle, right));
}

Cubic cubic_through(const std::array<double, 4>& values)
{
    const double d1 = values[1] - values[0], d2 = values[2] - values[0], d3 = values[3] - values[0];
    return {{values[0], values[0] + (18.0 * d1 - 9.0 * d2 + 2.0 * d3) / 6.0,
             values[0] + (-9.0 * d1 + 18.0 * d2 - 5.0 * d3) / 6.0, values[3]}};
}

std::vector<double> turning_points(const Cubic& cubic)
{
    const std::array<double, 4>& b = cubic.bernstein;
    // Derivative / 3 = d0 (1-t)^2 + 2 d1 t (1-t) + d2 t^2 = a t^2 + 2 h t + d0.
    const double d0 = b[1] - b[0], d1 = b[2] - b[1], d2 = b[3] - b[2];
    const double a = d0 - 2.0 * d1 + d2, h = d1 - d0;
    const double discriminant = h * h - a * d0;
    if (discriminant < 0.0) return {};
    const double q = -(h + std::copysign(std::sqrt(discriminant), h));
    std::vector<double> turns;
    for (const double t : {a != 0.0 ? q / a : -1.0, q != 0.0 ? d0 / q : -1.0}) {
        if (t > 0.0 && t < 1.0) turns.push_back(t);
    }
    std::sort(turns.begin(), turns.end());
    return turns;
}

std::vector<double> split_at_levels(const Cubic& cubic, std::span<const double> levels)
{
    std::vector<double> splits{0.0};
    std::vector<double> ends = turning_points(cubic);
    ends.push_back(1.0);
    for (const double end : ends) {
        const double start = splits.back();
        const auto [lowest, highest] = std::minmax({cubic.at(start), cubic.at(end)});
        const auto first = std::upper_bound(levels.begin(), levels.end(), lowest);
        const auto last = std::lower_bound(first, levels.end(), highest);
        for (auto level = first; level != last; ++level) splits.push_back(crossing(cubic, start, end, *level));
        std::sort(splits.begin(), splits.end());
        splits.push_back(end);
    }
    return splits;
}

}  // namespace shvr::reference

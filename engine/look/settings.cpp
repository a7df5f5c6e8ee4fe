#include "engine/look/settings.h"

#include <algorithm>
#include <cmath>

namespace shvr {

double seen_of(const OcclusionSettings& settings, double arrives)
{
    const std::vector<OcclusionPoint>& points = settings.mapping;
    if (points.empty()) return std::pow(arrives, settings.curve);
    const auto after =
        std::ranges::upper_bound(points, arrives, {}, [](const OcclusionPoint& point) { return point.arrives; });
    if (after == points.begin()) return points.front().seen;
    if (after == points.end()) return points.back().seen;
    const OcclusionPoint& before = *std::prev(after);
    return std::lerp(before.seen, after->seen, (arrives - before.arrives) / (after->arrives - before.arrives));
}

}  // namespace shvr

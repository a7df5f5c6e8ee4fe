#include "tests/reference/group_operations.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

namespace shvr::reference {

std::vector<std::vector<Size3>> components_of(const DenseGroups& dense, const std::function<bool(uint8_t)>& is_in,
                                              int64_t connectivity)
{
    std::vector<Size3> offsets;
    for_each_voxel(Size3(3), [&](const Size3& step) {
        const Size3 offset = step - int64_t{1};
        const int64_t axes = offset.x * offset.x + offset.y * offset.y + offset.z * offset.z;
        if (axes == 1 || (connectivity == 26 && axes > 1)) offsets.push_back(offset);
    });
    DenseGroups left{dense.size, {}};  // 1: in the set, and in no component yet
    for (const uint8_t group : dense.groups) left.groups.push_back(is_in(group));
    std::vector<std::vector<Size3>> components;
    for_each_voxel(dense.size, [&](const Size3& start) {
        if (left.at(start) == 0) return;
        std::vector<Size3> voxels{start};
        left.at(start) = 0;
        for (size_t next = 0; next < voxels.size(); ++next)
            for (const Size3& offset : offsets) {
                const Size3 voxel = voxels[next] + offset;
                if (!dense.contains(voxel) || left.at(voxel) == 0) continue;
                left.at(voxel) = 0;
                voxels.push_back(voxel);
            }
        components.push_back(std::move(voxels));
    });
    return components;
}

namespace {

DenseGroups wanted_by(const CombineOp& op, DenseGroups dense, const DenseVolume&)
{
    using How = CombineOp::How;
    for (uint8_t& voxel : dense.groups) {
        const bool is_group = voxel == op.group, is_with = voxel == op.with;
        if (is_with && (op.how == How::add || op.how == How::move || op.how == How::copy || op.how == How::swap))
            voxel = uint8_t(op.group);
        else if (is_group && (op.how == How::intersect || op.how == How::copy))
            voxel = 0;
        else if (is_group && op.how == How::swap)
            voxel = uint8_t(op.with);
    }
    return dense;
}

DenseGroups wanted_by(const IslandsOp& op, DenseGroups dense, const DenseVolume& volume)
{
    using Keep = IslandsOp::Keep;
    auto islands = components_of(
        dense, [&](uint8_t group) { return group == op.group; }, op.connectivity);
    std::ranges::stable_sort(islands, std::ranges::greater(), [](const auto& each) { return each.size(); });
    int64_t next = op.split_from.value_or(op.group);
    for (size_t i = 0; i < islands.size(); ++i) {
        const auto voxels = double(islands[i].size());
        bool stays = op.keep == Keep::all || (op.keep == Keep::largest && i == 0);
        if (op.keep == Keep::at_least)
            stays = op.voxels ? voxels >= double(*op.voxels)
                              : voxels * volume.spacing.x * volume.spacing.y * volume.spacing.z >= *op.mm3;
        if (op.keep == Keep::at) stays = std::ranges::find(islands[i], Size3(glm::floor(*op.at))) != islands[i].end();
        for (const Size3& voxel : islands[i]) dense.at(voxel) = stays ? uint8_t(next) : uint8_t(0);
        if (stays && op.split_from) ++next;
    }
    return dense;
}

DenseGroups wanted_by(const ThresholdOp& op, DenseGroups dense, const DenseVolume& volume)
{
    for (size_t i = 0; i < dense.groups.size(); ++i)
        if (volume.intensities[i] >= op.from.value_or(-1e300) && volume.intensities[i] <= op.to.value_or(1e300))
            dense.groups[i] = uint8_t(op.group);
    return dense;
}

DenseGroups wanted_by(const FillHolesOp& op, DenseGroups dense, const DenseVolume&)
{
    const auto parts = components_of(
        dense, [&](uint8_t group) { return group != op.group; }, 6);
    for (const auto& part : parts) {
        const bool reaches_border = std::ranges::any_of(part, [&](const Size3& voxel) {
            return glm::any(glm::equal(voxel, Size3(0))) || glm::any(glm::equal(voxel, dense.size - int64_t{1}));
        });
        if (reaches_border) continue;
        for (const Size3& voxel : part) dense.at(voxel) = uint8_t(op.group);
    }
    return dense;
}

using Set = std::vector<uint8_t>;

Set set_of(const DenseGroups& dense, int64_t group)
{
    Set set;
    for (const uint8_t voxel : dense.groups) set.push_back(voxel == group);
    return set;
}

/// The voxels within the distance of a voxel whose entry is `of`.
Set near(const Set& set, uint8_t of, const Size3& size, const glm::dvec3& spacing, double distance)
{
    const double most = distance * distance * (1.0 + 1e-9);
    const Size3 reach(glm::floor(distance / spacing) + 1.0);
    std::vector<Size3> offsets;
    for_each_voxel(int64_t{2} * reach + int64_t{1}, [&](const Size3& step) {
        const glm::dvec3 away = glm::dvec3(step - reach) * spacing;
        if (glm::dot(away, away) <= most) offsets.push_back(step - reach);
    });
    const DenseGroups dense{size, set};
    Set found(set.size());
    size_t next = 0;
    for_each_voxel(size, [&](const Size3& voxel) {
        found[next++] = std::ranges::any_of(offsets, [&](const Size3& offset) {
            return dense.contains(voxel + offset) && dense.at(voxel + offset) == of;
        });
    });
    return found;
}

Set shrunk(Set set, const Size3& size, const glm::dvec3& spacing, double distance)
{
    const Set rim = near(set, 0, size, spacing, distance);
    for (size_t i = 0; i < set.size(); ++i) set[i] = set[i] != 0 && rim[i] == 0;
    return set;
}

DenseGroups replaced(DenseGroups dense, int64_t group, const Set& set)
{
    for (size_t i = 0; i < set.size(); ++i) {
        uint8_t& voxel = dense.groups[i];
        voxel = set[i] != 0 ? uint8_t(group) : voxel == group ? uint8_t(0) : voxel;
    }
    return dense;
}

DenseGroups wanted_by(const GrowOp& op, DenseGroups dense, const DenseVolume& volume)
{
    return replaced(dense, op.group, near(set_of(dense, op.group), 1, dense.size, volume.spacing, op.distance));
}

DenseGroups wanted_by(const ShrinkOp& op, DenseGroups dense, const DenseVolume& volume)
{
    return replaced(dense, op.group, shrunk(set_of(dense, op.group), dense.size, volume.spacing, op.distance));
}

DenseGroups wanted_by(const OpenOp& op, DenseGroups dense, const DenseVolume& volume)
{
    const Set small = shrunk(set_of(dense, op.group), dense.size, volume.spacing, op.distance);
    return replaced(dense, op.group, near(small, 1, dense.size, volume.spacing, op.distance));
}

DenseGroups wanted_by(const CloseOp& op, DenseGroups dense, const DenseVolume& volume)
{
    const Set large = near(set_of(dense, op.group), 1, dense.size, volume.spacing, op.distance);
    return replaced(dense, op.group, shrunk(large, dense.size, volume.spacing, op.distance));
}

DenseGroups wanted_by(const HollowOp& op, DenseGroups dense, const DenseVolume& volume)
{
    using Side = HollowOp::Side;
    const double wall = op.side == Side::both ? op.wall / 2.0 : op.wall;
    const Set group = set_of(dense, op.group), inner = shrunk(group, dense.size, volume.spacing, wall),
              outer = near(group, 1, dense.size, volume.spacing, wall);
    Set set(group.size());
    for (size_t i = 0; i < set.size(); ++i)
        set[i] = (op.side != Side::out && group[i] != 0 && inner[i] == 0) ||
                 (op.side != Side::in && group[i] == 0 && outer[i] != 0);
    return replaced(dense, op.group, set);
}

DenseGroups wanted_by(const SmoothOp& op, DenseGroups dense, const DenseVolume& volume)
{
    const auto is_chosen = [&](uint8_t group) { return std::ranges::find(op.groups, group) != op.groups.end(); };
    const DenseGroups before = dense;
    const Size3 reach(glm::floor(op.distance * (1.0 + 5e-10) / volume.spacing));
    const auto weight = [&](const Size3& offset) {
        const glm::dvec3 away = glm::dvec3(offset) * volume.spacing;
        if (op.method == SmoothOp::Method::median)
            return int64_t{glm::dot(away, away) <= op.distance * op.distance * (1.0 + 1e-9)};
        int64_t product = 1;
        for (int axis = 0; axis < 3; ++axis) {
            const double sigmas = 2.0 * away[axis] / op.distance;
            product *= std::llround(1024.0 * std::exp(-0.5 * sigmas * sigmas));
        }
        return product;
    };
    for_each_voxel(dense.size, [&](const Size3& voxel) {
        std::vector<int64_t> weights(256);
        for_each_voxel(int64_t{2} * reach + int64_t{1}, [&](const Size3& step) {
            const Size3 other = voxel + step - reach;
            if (dense.contains(other)) weights[before.at(other)] += weight(step - reach);
        });
        const uint8_t own = before.at(voxel);
        const auto most = std::ranges::max_element(weights);
        const uint8_t winner = weights[own] == *most ? own : uint8_t(most - weights.begin());
        if (op.groups.empty() || is_chosen(own) || is_chosen(winner)) dense.at(voxel) = winner;
    });
    return dense;
}

/// The distance in a slice to the nearest voxel that is in the group or, from inside, to the nearest that is not, which
/// is then below 0; beyond the volume none is.
double signed_distance(const DenseGroups& dense, const Size3& voxel, int axis, int64_t group, const glm::dvec3& spacing)
{
    const auto is_in = [&](const Size3& at) { return dense.contains(at) && dense.at(at) == group; };
    const bool is_inside = is_in(voxel);
    double best = 1e300;
    Size3 lower(-1), size = dense.size + int64_t{2};
    lower[axis] = voxel[axis];
    size[axis] = 1;
    for_each_voxel(size, [&](const Size3& step) {
        const Size3 other = lower + step;
        if (is_in(other) != is_inside) best = std::min(best, glm::length(glm::dvec3(other - voxel) * spacing));
    });
    return is_inside ? -best : best;
}

DenseGroups wanted_by(const FillBetweenOp& op, DenseGroups dense, const DenseVolume& volume)
{
    const DenseGroups before = dense;
    const int axis = int(op.axis);
    std::vector<bool> is_painted(size_t(dense.size[axis]));
    for_each_voxel(dense.size, [&](const Size3& voxel) {
        if (before.at(voxel) == op.group) is_painted[size_t(voxel[axis])] = true;
    });
    for_each_voxel(dense.size, [&](const Size3& voxel) {
        Size3 from = voxel, to = voxel;
        while (from[axis] >= 0 && !is_painted[size_t(from[axis])]) --from[axis];
        while (to[axis] < dense.size[axis] && !is_painted[size_t(to[axis])]) ++to[axis];
        if (from[axis] < 0 || to[axis] == dense.size[axis] || from == to) return;
        const double before_it = signed_distance(before, from, axis, op.group, volume.spacing),
                     after_it = signed_distance(before, to, axis, op.group, volume.spacing);
        const double share = double(voxel[axis] - from[axis]) / double(to[axis] - from[axis]);
        if (before_it + share * (after_it - before_it) <= 1e-9 * (std::abs(before_it) + std::abs(after_it)))
            dense.at(voxel) = uint8_t(op.group);
    });
    return dense;
}

double squared_gradient(const DenseGroups& dense, const DenseVolume& volume, const Size3& voxel)
{
    const auto value = [&](const Size3& at) {
        return volume.intensities[size_t(at.x + dense.size.x * (at.y + dense.size.y * at.z))];
    };
    double sum = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        Size3 step(0);
        step[axis] = 1;
        const bool has_before = dense.contains(voxel - step), has_after = dense.contains(voxel + step);
        if (!has_before && !has_after) continue;
        const double rise = value(has_after ? voxel + step : voxel) - value(has_before ? voxel - step : voxel);
        const double slope = rise / (double(int(has_before) + int(has_after)) * volume.spacing[axis]);
        sum += slope * slope;
    }
    return sum;
}

DenseGroups wanted_by(const GrowSeedsOp& op, DenseGroups dense, const DenseVolume& volume)
{
    const DenseGroups before = dense;
    const auto is_seed = [&](uint8_t group) {
        const bool is_chosen = op.groups.empty() ? op.limits.inside != group : std::ranges::count(op.groups, group) > 0;
        return group != 0 && is_chosen && !volume.locked[group];
    };
    const auto is_in_box = [&](const Size3& voxel, const std::optional<VoxelBox>& box) {
        return !box ||
               (glm::all(glm::greaterThanEqual(voxel, box->lower)) && glm::all(glm::lessThan(voxel, box->upper)));
    };
    const auto is_behind = [&](const Size3& voxel) { return is_behind_plane(voxel, op.limits, volume.spacing); };
    std::vector<Size3> seeds;
    VoxelBox near{Size3(1 << 30), Size3(-(1 << 30))};
    for_each_voxel(dense.size, [&](const Size3& voxel) {
        if (!is_seed(before.at(voxel)) || !is_in_box(voxel, op.limits.box) || !is_behind(voxel)) return;
        seeds.push_back(voxel);
        near = {glm::min(near.lower, voxel), glm::max(near.upper, voxel + int64_t{1})};
    });
    const int64_t margin = op.margin.value_or(op.limits.box ? 1 << 30 : GrowSeedsOp::MARGIN);
    near = {near.lower - margin, near.upper + margin};
    std::vector<uint8_t> is_reached(dense.groups.size());
    std::multimap<double, Size3> frontier;  // keeps the order of equal costs
    const auto reach_from = [&](const Size3& voxel) {
        for (const Size3& step :
             {Size3(0, 0, -1), Size3(0, -1, 0), Size3(-1, 0, 0), Size3(1, 0, 0), Size3(0, 1, 0), Size3(0, 0, 1)}) {
            const Size3 next = voxel + step;
            if (!dense.contains(next) || !is_in_box(next, op.limits.box) || !is_in_box(next, near)) continue;
            if (!is_behind(next)) continue;
            const auto index = size_t(next.x + dense.size.x * (next.y + dense.size.y * next.z));
            const uint8_t held = before.at(next);
            const double value = volume.intensities[index];
            const bool is_wall = is_seed(held) || volume.locked[held] || (op.limits.only_unpainted && held != 0) ||
                                 (op.limits.inside && *op.limits.inside != held) ||
                                 (op.limits.within && (value < op.limits.within->x || value > op.limits.within->y));
            if (is_wall || is_reached[index] != 0) continue;
            is_reached[index] = 1;
            dense.groups[index] = dense.at(voxel);
            const double cost = op.on == GrowSeedsOp::On::gradient    ? squared_gradient(before, volume, next)
                                : op.on == GrowSeedsOp::On::intensity ? value
                                                                      : -value;
            frontier.emplace(std::isnan(cost) ? std::numeric_limits<double>::infinity() : cost, next);
        }
    };
    for (const Size3& seed : seeds) reach_from(seed);
    while (!frontier.empty()) {
        const Size3 voxel = frontier.begin()->second;
        frontier.erase(frontier.begin());
        reach_from(voxel);
    }
    return dense;
}

/// Whether a line from the point to the right crosses the polygon an odd number of times.
bool is_enclosed(const glm::dvec2& point, const std::vector<glm::dvec2>& polygon)
{
    int crossings = 0;
    for (size_t i = 0; i < polygon.size(); ++i) {
        glm::dvec2 low = polygon[i], high = polygon[(i + 1) % polygon.size()];
        if (low.y > high.y) std::swap(low, high);
        if (point.y < low.y || point.y >= high.y) continue;
        // To the left of the side: the area of the triangle (low, high, point) is above 0.
        const double area = (high.x - low.x) * (point.y - low.y) - (high.y - low.y) * (point.x - low.x);
        crossings += area > 0.0;
    }
    return crossings % 2 == 1;
}

/// To the right, upwards and forwards, from the lower left corner of the face of the volume.
glm::dvec3 seen_from(LassoView::Face face, const glm::dvec3& at, const glm::dvec3& extent)
{
    const glm::dvec3 from_end = extent - at;
    switch (face) {
        case LassoView::Face::front: return {at.x, at.z, at.y};
        case LassoView::Face::back: return {from_end.x, at.z, from_end.y};
        case LassoView::Face::left: return {from_end.y, at.z, at.x};
        case LassoView::Face::right: return {at.y, at.z, from_end.x};
        case LassoView::Face::top: return {at.x, at.y, from_end.z};
        case LassoView::Face::bottom: return {from_end.x, at.y, at.z};
        case LassoView::Face::none: break;
    }
    throw std::logic_error("no face");
}

DenseGroups wanted_by(const LassoOp& op, DenseGroups dense, const DenseVolume& volume)
{
    const glm::dvec3 forward = glm::normalize(op.view.target - op.view.eye),
                     right = glm::normalize(glm::cross(forward, op.view.up)), up = glm::cross(right, forward),
                     extent = glm::dvec3(dense.size) * volume.spacing;
    const bool is_perspective = op.view.projection == LassoView::Projection::perspective;
    for_each_voxel(dense.size, [&](const Size3& voxel) {
        uint8_t& group = dense.at(voxel);
        if (group == 0 || (!op.groups.empty() && std::ranges::count(op.groups, group) == 0)) return;
        const glm::dvec3 at = (glm::dvec3(voxel) + 0.5) * volume.spacing, way = at - op.view.eye;
        glm::dvec3 seen(glm::dot(way, right), glm::dot(way, up), glm::dot(way, forward));
        if (op.view.face != LassoView::Face::none) seen = seen_from(op.view.face, at, extent);
        if (op.depth && (seen.z < op.depth->x || seen.z > op.depth->y)) return;
        const glm::dvec2 place = is_perspective ? glm::dvec2(seen) / seen.z : glm::dvec2(seen);
        const bool encloses = (!is_perspective || seen.z > 0.0) && is_enclosed(place, op.polygon);
        if (encloses == (op.side == LassoOp::Side::inside)) group = uint8_t(op.to_group);
    });
    return dense;
}

/// The least of distance minus radius over the balls on the way from a to b, by golden sections: both are convex.
double outside_by(const glm::dvec3& point, const TraceGraph& trace, const TraceInternode& internode)
{
    const glm::dvec3 a = trace.node(internode.a).position, b = trace.node(internode.b).position;
    const double from = trace.radius_of(internode, 0.0), to = trace.radius_of(internode, 1.0);
    const auto at = [&](double t) { return glm::distance(point, a + t * (b - a)) - (from + t * (to - from)); };
    constexpr double GOLDEN = 0.6180339887498949;
    double low = 0.0, high = 1.0;
    for (int i = 0; i < 40; ++i) {
        const double left = high - GOLDEN * (high - low), right = low + GOLDEN * (high - low);
        (at(left) < at(right) ? high : low) = at(left) < at(right) ? right : left;
    }
    return std::min({at(low), at(0.0), at(1.0)});
}

DenseGroups wanted_by(const MaskFromTraceOp& op, DenseGroups dense, const DenseVolume& volume)
{
    const auto is_chosen = [&](uint8_t group) { return op.of.empty() || std::ranges::count(op.of, group) > 0; };
    for_each_voxel(dense.size, [&](const Size3& voxel) {
        const glm::dvec3 point = (glm::dvec3(voxel) + 0.5) * volume.spacing;
        double least = 1e300;
        for (const auto& [number, node] : volume.trace->nodes())
            if (is_chosen(node.group)) least = std::min(least, glm::distance(point, node.position) - node.radius);
        for (const auto& [number, internode] : volume.trace->internodes())
            if (is_chosen(internode.group)) least = std::min(least, outside_by(point, *volume.trace, internode));
        if (least <= 1e-10) dense.at(voxel) = uint8_t(op.group);
    });
    return dense;
}

DenseGroups wanted_by(const TraceFromMaskOp&, DenseGroups dense, const DenseVolume&)
{
    return dense;  // changes no voxel
}

}  // namespace

bool is_behind_plane(const Size3& voxel, const OperationLimits& limits, const glm::dvec3& spacing)
{
    if (!limits.plane_normal) return true;
    double beyond = 0.0;
    for (int axis = 0; axis < 3; ++axis)
        beyond +=
            (*limits.plane_normal)[axis] * spacing[axis] * (double(voxel[axis]) + 0.5 - (*limits.plane_point)[axis]);
    return beyond <= 0.0;
}

DenseGroups wanted(const GroupOperation& operation, const DenseGroups& before, const DenseVolume& volume)
{
    return std::visit([&](const auto& op) { return wanted_by(op, before, volume); }, operation);
}

}  // namespace shvr::reference

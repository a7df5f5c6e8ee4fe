#include "engine/annotation/sets/middles.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace shvr {

namespace {

/// Calls `visit(at)` for the voxels below a place along an axis, then for those above, each until it returns false.
template <class Visit>
void go_both_ways(int64_t place, int64_t size, const Visit& visit)
{
    const int64_t below = (place - 1) >> 1;  // rounded down
    for (int64_t at = below; at >= 0 && visit(at);) --at;
    for (int64_t at = below + 1; at < size && visit(at);) ++at;
}

}  // namespace

Middles::Middles(const BrickSet& set, const Reach& reach)
    : set_(set), size_(reach.mask.size()), counts_(reach.mask.brick_counts()), spacing_(reach.spacing)
{}

uint32_t Middles::row_of(const Size3& voxel)
{
    const Size3 at = voxel / BRICK_SIDE;
    const int64_t brick = index_of(at, counts_);
    Slot& slot = slots_[size_t(at.x % 4 + 4 * (at.y % 4) + 16 * (at.z % 4))];
    if (slot.brick != brick) {
        const auto found = set_.find(brick);
        slot = {brick, found == set_.end() ? nullptr : &found->second};
    }
    return slot.bits ? (*slot.bits)[size_t(voxel.y % BRICK_SIDE + BRICK_SIDE * (voxel.z % BRICK_SIDE))] : 0u;
}

int64_t Middles::outside_below(Size3 first)
{
    while (first.x >= 0) {
        const int64_t bit = first.x % BRICK_SIDE;
        const uint32_t outside = ~row_of(first) & (~0u >> (BRICK_SIDE - 1 - bit));
        if (outside != 0) return first.x - bit + BRICK_SIDE - 1 - std::countl_zero(outside);
        first.x -= bit + 1;
    }
    return -1;
}

int64_t Middles::outside_above(Size3 first)
{
    while (first.x < size_.x) {
        const int64_t bit = first.x % BRICK_SIDE;
        const uint32_t outside = ~row_of(first) & (~0u << bit);
        if (outside != 0) {
            const int64_t x = first.x - bit + std::countr_zero(outside);
            return x < size_.x ? x : -1;
        }
        first.x += BRICK_SIDE - bit;
    }
    return -1;
}

double Middles::squared(int axis, const Place& from, int64_t at) const
{
    const double away = 0.5 * double(2 * at + 1 - from[axis]) * spacing_[axis];
    return away * away;
}

double Middles::measured(const Place& place, double least)
{
    double best = std::numeric_limits<double>::infinity();
    const double enough = least * least;
    const int64_t below = (place.x - 1) >> 1;
    const auto take = [&](int64_t x, double squared_in_plane) {
        if (x >= 0) best = std::min(best, squared_in_plane + squared(0, place, x));
    };
    go_both_ways(place.z, size_.z, [&](int64_t z) {
        const double along_z = squared(2, place, z);
        if (along_z >= best || best <= enough) return false;
        go_both_ways(place.y, size_.y, [&](int64_t y) {
            const double in_plane = along_z + squared(1, place, y);
            if (in_plane >= best || best <= enough) return false;
            if (below >= 0) take(outside_below({below, y, z}), in_plane);
            take(outside_above({below + 1, y, z}), in_plane);
            return true;
        });
        return true;
    });
    return std::sqrt(best);
}

double Middles::distance_of(const Place& place, double least)
{
    Known& known = known_[index_of(place, int64_t{2} * size_)];
    if (known.is_exact || (known.distance > 0.0 && known.distance <= least)) return known.distance;
    known.distance = measured(place, least);
    known.is_exact = known.distance > least;
    return known.distance;
}

/// Mean of `distance`, to the nearest voxel centre outside the set, and the next smaller distance of a voxel centre.
double Middles::radius_at(const Place& place, double distance) const
{
    if (distance == std::numeric_limits<double>::infinity()) return glm::length(glm::dvec3(size_) * spacing_);
    const double limit = distance * distance * (1.0 - 1e-9);
    double most = 0.0;
    const auto along = [&](int axis, double left, const auto& visit) {
        const double first = place[axis] % 2 == 0 ? 0.5 : 0.0;
        for (double away = first;; away += 1.0) {
            const double square = away * away * spacing_[axis] * spacing_[axis];
            if (!(square < left)) return;
            visit(square);
        }
    };
    along(2, limit, [&](double z) {
        along(1, limit - z, [&](double yz) {
            const double left = limit - z - yz, first = place.x % 2 == 0 ? 0.5 : 0.0;
            const double away = first + std::floor(std::sqrt(left) / spacing_.x - first);
            if (away >= 0.0) most = std::max(most, z + yz + away * away * spacing_.x * spacing_.x);
        });
    });
    return 0.5 * (distance + std::sqrt(std::min(most, limit)));
}

MiddleBall Middles::near(const Size3& voxel)
{
    constexpr int MAX_STEPS = 4;
    Place place = int64_t{2} * voxel + int64_t{1};
    double distance = distance_of(place, 0.0);
    for (int step = 0; step < MAX_STEPS; ++step) {
        Place best = place;
        for (int64_t i = 0; i < 27; ++i) {
            const Place next = place + position_of(i, Size3(3)) - int64_t{1};
            if (glm::any(glm::lessThan(next, Size3(1))) || glm::any(glm::greaterThanEqual(next, int64_t{2} * size_)))
                continue;
            const double there = distance_of(next, distance);
            if (there <= distance * (1.0 + 1e-9)) continue;
            best = next;
            distance = there;
        }
        if (best == place) break;
        place = best;
    }
    return {0.5 * glm::dvec3(place) * spacing_, radius_at(place, distance)};
}

}  // namespace shvr

#include "engine/look/surfaces/surface_tree.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/base/error.h"
#include "engine/base/finite.h"
#include "engine/look/split_digits.h"
#include "engine/look/surfaces/box_tree.h"
#include "engine/volume/grid.h"

namespace shvr {

namespace {

constexpr double NEAREST = -double(MAX_SIDE), FARTHEST = 2.0 * double(MAX_SIDE), MAX_RADIUS = double(MAX_SIDE);
/// Tolerance, as a share of the radii's difference, for drawing a rod as a ball if one of its balls contains the other.
constexpr double CONTAINED = 1e-5;

bool is_within(const glm::dvec3& v)
{
    return is_finite(v) && glm::all(glm::greaterThanEqual(v, glm::dvec3(NEAREST))) &&
           glm::all(glm::lessThanEqual(v, glm::dvec3(FARTHEST)));
}

std::string name_of(uint64_t key)
{
    constexpr const char* KINDS[] = {"surface ", "node ", "internode "};
    return KINDS[key >> 32] + std::to_string(uint32_t(key));
}

/// Returns the number by which the device breaks ties between surfaces, kind first. Numbers from 2^30 on may coincide,
/// which affects only ties.
uint32_t order_of(uint64_t key)
{
    return uint32_t(key >> 32) << 30 | (uint32_t(key) & 0x3fffffffu);
}

void check(const SurfaceLook& surface, uint64_t key, double reference_length)
{
    for (const glm::dvec3& point : {surface.from, surface.to})
        if (!is_within(point / reference_length))
            fail(name_of(key), ": an end is at (", point.x, ", ", point.y, ", ", point.z, "); expected ",
                 NEAREST * reference_length, " ... ", FARTHEST * reference_length, " along each axis");
    for (const double radius : {surface.radius_from, surface.radius_to})
        if (!(radius > 0.0 && radius / reference_length <= MAX_RADIUS))
            fail(name_of(key), ": a radius is ", radius, "; expected more than 0 and at most ",
                 MAX_RADIUS * reference_length);
    if (!is_finite(surface.color)) fail(name_of(key), ": its colour is not finite; expected three finite numbers");
}

gpu::Surface on_device(const SurfaceLook& look, uint64_t key, double reference_length)
{
    glm::dvec3 from = look.from / reference_length, to = look.to / reference_length;
    double radius_from = look.radius_from / reference_length, radius_to = look.radius_to / reference_length;
    if (glm::distance(from, to) <= (1.0 + CONTAINED) * std::abs(radius_from - radius_to)) {
        if (radius_to > radius_from) from = to;
        to = from;
        radius_from = radius_to = std::max(radius_from, radius_to);
    }
    gpu::Surface surface{};
    split_digits(from, surface.from, surface.from_rest);
    surface.along = to - from;
    surface.radius_from = float(radius_from);
    surface.radius_to = float(radius_to);
    surface.color = look.color;
    surface.number = order_of(key);
    return surface;
}

SurfaceBox box_of(const gpu::Surface& surface)
{
    const glm::dvec3 from = glm::dvec3(surface.from) + glm::dvec3(surface.from_rest);
    const glm::dvec3 to = from + glm::dvec3(surface.along);
    SurfaceBox box;
    box.add(from - double(surface.radius_from), from + double(surface.radius_from));
    box.add(to - double(surface.radius_to), to + double(surface.radius_to));
    return box;
}

}  // namespace

double reference_length_of(const VolumeInfo& volume)
{
    return std::min({volume.spacing.x, volume.spacing.y, volume.spacing.z});
}

std::vector<KeyedSurface> keyed(std::span<const SurfaceLook> surfaces)
{
    std::vector<KeyedSurface> all;
    all.reserve(surfaces.size());
    for (const SurfaceLook& look : surfaces)
        all.push_back({surface_key(SurfaceKind::session, uint32_t(all.size())), look});
    return all;
}

gpu::Surface surface_on_device(const KeyedSurface& surface, const VolumeInfo& volume)
{
    const double reference_length = reference_length_of(volume);
    check(surface.look, surface.key, reference_length);
    return on_device(surface.look, surface.key, reference_length);
}

SurfaceTree surface_tree(std::span<const KeyedSurface> surfaces, const VolumeInfo& volume, size_t max_in_leaf)
{
    if (surfaces.size() > MAX_SURFACES)
        fail(surfaces.size(), " surfaces are to be drawn; expected at most ", MAX_SURFACES);
    std::vector<gpu::Surface> all;
    std::vector<BoxedSurface> items;
    all.reserve(surfaces.size());
    items.reserve(surfaces.size());
    for (size_t i = 0; i < surfaces.size(); ++i) {
        all.push_back(surface_on_device(surfaces[i], volume));
        const SurfaceBox box = box_of(all.back());
        items.push_back({box, 0.5 * (box.lower + box.upper), uint32_t(i)});
    }
    SurfaceTree tree;
    if (items.empty()) return tree;
    tree.nodes = box_tree(items, max_in_leaf);
    tree.list.reserve(all.size());
    tree.keys.reserve(all.size());
    for (const BoxedSurface& item : items) {
        tree.list.push_back(all[item.surface]);
        tree.keys.push_back(surfaces[item.surface].key);
    }
    return tree;
}

std::vector<uint32_t> refit(std::span<gpu::SurfaceNode> nodes, std::span<const gpu::Surface> list)
{
    std::vector<uint32_t> changed;
    for (size_t node = nodes.size(); node-- > 0;) {  // children come after their parents
        gpu::SurfaceNode& parent = nodes[node];
        glm::vec3 lower(INFINITY), upper(-INFINITY);
        for (size_t child = node + 1; child < parent.skip; child = nodes[child].skip) {
            lower = glm::min(lower, nodes[child].lower);
            upper = glm::max(upper, nodes[child].upper);
        }
        if (parent.begin < parent.end) {
            SurfaceBox box;
            for (uint32_t i = parent.begin; i < parent.end; ++i) box.add(box_of(list[i]));
            lower = rounded_down(box.lower);
            upper = rounded_up(box.upper);
        }
        // A leaf whose surfaces were all removed keeps its box.
        if (lower.x > upper.x || (lower == parent.lower && upper == parent.upper)) continue;
        parent.lower = lower;
        parent.upper = upper;
        changed.push_back(uint32_t(node));
    }
    return changed;
}

}  // namespace shvr

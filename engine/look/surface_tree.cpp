#include "engine/look/surface_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>

#include "engine/base/error.h"
#include "engine/base/finite.h"
#include "engine/volume/grid.h"

namespace shvr {

namespace {

constexpr double NEAREST = -double(MAX_SIDE), FARTHEST = 2.0 * double(MAX_SIDE), MAX_RADIUS = double(MAX_SIDE);
/// Tolerance, as a share of the radii's difference, for drawing a rod as a ball if one of its balls contains the other.
constexpr double CONTAINED = 1e-5;

struct Box {
    glm::dvec3 lower{INFINITY}, upper{-INFINITY};
    void add(const glm::dvec3& low, const glm::dvec3& high)
    {
        lower = glm::min(lower, low), upper = glm::max(upper, high);
    }
    void add(const Box& box) { add(box.lower, box.upper); }
    double half_area() const
    {
        const glm::dvec3 d = glm::max(upper - lower, 0.0);
        return d.x * d.y + d.y * d.z + d.z * d.x;
    }
};

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
    surface.from = from;
    surface.from_rest = from - glm::dvec3(surface.from);
    surface.along = to - from;
    surface.radius_from = float(radius_from);
    surface.radius_to = float(radius_to);
    surface.color = look.color;
    surface.number = order_of(key);
    return surface;
}

Box box_of(const gpu::Surface& surface)
{
    const glm::dvec3 from = glm::dvec3(surface.from) + glm::dvec3(surface.from_rest);
    const glm::dvec3 to = from + glm::dvec3(surface.along);
    Box box;
    box.add(from - double(surface.radius_from), from + double(surface.radius_from));
    box.add(to - double(surface.radius_to), to + double(surface.radius_to));
    return box;
}

glm::vec3 rounded(const glm::dvec3& v, float towards)
{
    const glm::vec3 f(v);
    return {std::nextafter(f.x, towards), std::nextafter(f.y, towards), std::nextafter(f.z, towards)};
}

double reference_length_of(const VolumeInfo& volume)
{
    return std::min({volume.spacing.x, volume.spacing.y, volume.spacing.z});
}

struct Item {
    Box box;
    glm::dvec3 middle{0.0};
    uint32_t surface = 0;
};

/// Splits by the surface area heuristic (MacDonald and Booth 1990), evaluated over bins (Wald 2007).
class Builder {
public:
    Builder(std::vector<Item>& items, size_t max_in_leaf, std::vector<gpu::SurfaceNode>& nodes)
        : items_(items), max_in_leaf_(max_in_leaf), nodes_(nodes)
    {}

    /// Adds items begin ... end. Both sides of a split get at least a sixteenth of the items, which bounds the depth.
    void add(size_t begin, size_t end)
    {
        Box box;
        for (size_t i = begin; i < end; ++i) box.add(items_[i].box);
        const size_t node = nodes_.size();
        nodes_.push_back({.lower = rounded(box.lower, -INFINITY), .upper = rounded(box.upper, INFINITY)});
        nodes_[node].begin = nodes_[node].end = uint32_t(begin);
        if (end - begin <= max_in_leaf_) {
            nodes_[node].end = uint32_t(end);
        } else {
            const size_t middle = split(begin, end);
            add(begin, middle);
            add(middle, end);
        }
        nodes_[node].skip = uint32_t(nodes_.size());
    }

private:
    static constexpr int BINS = 16;

    size_t split(size_t begin, size_t end)
    {
        Box middles;
        for (size_t i = begin; i < end; ++i) middles.add(items_[i].middle, items_[i].middle);
        const glm::dvec3 extent = middles.upper - middles.lower;
        const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
        const auto bin_of = [&](const Item& item) {
            return std::min(int(BINS * (item.middle[axis] - middles.lower[axis]) / extent[axis]), BINS - 1);
        };
        if (extent[axis] > 0.0) {
            const auto first = items_.begin() + ptrdiff_t(begin), last = items_.begin() + ptrdiff_t(end);
            const int border = best_border(begin, end, bin_of);
            const auto middle = std::partition(first, last, [&](const Item& item) { return bin_of(item) < border; });
            const size_t at = size_t(middle - items_.begin());
            if (std::min(at - begin, end - at) * BINS >= end - begin) return at;
        }
        const size_t half = begin + (end - begin) / 2;
        std::nth_element(items_.begin() + ptrdiff_t(begin), items_.begin() + ptrdiff_t(half),
                         items_.begin() + ptrdiff_t(end), [axis](const Item& a, const Item& b) {
                             return a.middle[axis] != b.middle[axis] ? a.middle[axis] < b.middle[axis]
                                                                     : a.surface < b.surface;
                         });
        return half;
    }

    /// The first bin of the second half.
    template <class BinOf>
    int best_border(size_t begin, size_t end, const BinOf& bin_of) const
    {
        std::array<Box, BINS> boxes;
        std::array<size_t, BINS> counts{};
        for (size_t i = begin; i < end; ++i) {
            const auto bin = size_t(bin_of(items_[i]));
            boxes[bin].add(items_[i].box);
            ++counts[bin];
        }
        std::array<double, BINS> below{};  // cost of the items below each border
        Box box;
        size_t count = 0;
        for (size_t bin = 0; bin + 1 < BINS; ++bin) {
            box.add(boxes[bin]);
            below[bin + 1] = box.half_area() * double(count += counts[bin]);
        }
        box = Box();
        count = 0;
        int best = BINS / 2;
        double best_cost = INFINITY;
        for (size_t border = BINS - 1; border > 0; --border) {
            box.add(boxes[border]);
            const double cost = below[border] + box.half_area() * double(count += counts[border]);
            if (cost < best_cost) best_cost = cost, best = int(border);
        }
        return best;
    }

    std::vector<Item>& items_;
    size_t max_in_leaf_;
    std::vector<gpu::SurfaceNode>& nodes_;
};

}  // namespace

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
    std::vector<Item> items;
    all.reserve(surfaces.size());
    items.reserve(surfaces.size());
    for (size_t i = 0; i < surfaces.size(); ++i) {
        all.push_back(surface_on_device(surfaces[i], volume));
        const Box box = box_of(all.back());
        items.push_back({box, 0.5 * (box.lower + box.upper), uint32_t(i)});
    }
    SurfaceTree tree;
    if (items.empty()) return tree;
    Builder(items, std::max<size_t>(max_in_leaf, 1), tree.nodes).add(0, items.size());
    tree.list.reserve(all.size());
    tree.keys.reserve(all.size());
    for (const Item& item : items) {
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
            Box box;
            for (uint32_t i = parent.begin; i < parent.end; ++i) box.add(box_of(list[i]));
            lower = rounded(box.lower, -INFINITY);
            upper = rounded(box.upper, INFINITY);
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

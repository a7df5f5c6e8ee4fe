#include "engine/look/surfaces/box_tree.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace shvr {

namespace {

glm::vec3 rounded(const glm::dvec3& v, float towards)
{
    const glm::vec3 f(v);
    return {std::nextafter(f.x, towards), std::nextafter(f.y, towards), std::nextafter(f.z, towards)};
}

/// Splits by the surface area heuristic (MacDonald and Booth 1990), evaluated over bins (Wald 2007).
class Builder {
public:
    Builder(std::span<BoxedSurface> items, size_t max_in_leaf, std::vector<gpu::SurfaceNode>& nodes)
        : items_(items), max_in_leaf_(max_in_leaf), nodes_(nodes)
    {}

    /// Adds items begin ... end. Both sides of a split get at least a sixteenth of the items, which bounds the depth.
    void add(size_t begin, size_t end)
    {
        SurfaceBox box;
        for (size_t i = begin; i < end; ++i) box.add(items_[i].box);
        const size_t node = nodes_.size();
        nodes_.push_back({.lower = rounded_down(box.lower), .upper = rounded_up(box.upper)});
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
        SurfaceBox middles;
        for (size_t i = begin; i < end; ++i) middles.add(items_[i].middle, items_[i].middle);
        const glm::dvec3 extent = middles.upper - middles.lower;
        const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
        const auto bin_of = [&](const BoxedSurface& item) {
            return std::min(int(BINS * (item.middle[axis] - middles.lower[axis]) / extent[axis]), BINS - 1);
        };
        if (extent[axis] > 0.0) {
            const auto first = items_.begin() + ptrdiff_t(begin), last = items_.begin() + ptrdiff_t(end);
            const int border = best_border(begin, end, bin_of);
            const auto middle =
                std::partition(first, last, [&](const BoxedSurface& item) { return bin_of(item) < border; });
            const size_t at = size_t(middle - items_.begin());
            if (std::min(at - begin, end - at) * BINS >= end - begin) return at;
        }
        const size_t half = begin + (end - begin) / 2;
        std::nth_element(items_.begin() + ptrdiff_t(begin), items_.begin() + ptrdiff_t(half),
                         items_.begin() + ptrdiff_t(end), [axis](const BoxedSurface& a, const BoxedSurface& b) {
                             return a.middle[axis] != b.middle[axis] ? a.middle[axis] < b.middle[axis]
                                                                     : a.surface < b.surface;
                         });
        return half;
    }

    /// The first bin of the second half.
    template <class BinOf>
    int best_border(size_t begin, size_t end, const BinOf& bin_of) const
    {
        std::array<SurfaceBox, BINS> boxes;
        std::array<size_t, BINS> counts{};
        for (size_t i = begin; i < end; ++i) {
            const auto bin = size_t(bin_of(items_[i]));
            boxes[bin].add(items_[i].box);
            ++counts[bin];
        }
        std::array<double, BINS> below{};  // cost of the items below each border
        SurfaceBox box;
        size_t count = 0;
        for (size_t bin = 0; bin + 1 < BINS; ++bin) {
            box.add(boxes[bin]);
            below[bin + 1] = box.half_area() * double(count += counts[bin]);
        }
        box = SurfaceBox();
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

    std::span<BoxedSurface> items_;
    size_t max_in_leaf_;
    std::vector<gpu::SurfaceNode>& nodes_;
};

}  // namespace

double SurfaceBox::half_area() const
{
    const glm::dvec3 d = glm::max(upper - lower, 0.0);
    return d.x * d.y + d.y * d.z + d.z * d.x;
}

glm::vec3 rounded_down(const glm::dvec3& v)
{
    return rounded(v, -INFINITY);
}

glm::vec3 rounded_up(const glm::dvec3& v)
{
    return rounded(v, INFINITY);
}

std::vector<gpu::SurfaceNode> box_tree(std::span<BoxedSurface> items, size_t max_in_leaf)
{
    std::vector<gpu::SurfaceNode> nodes;
    if (!items.empty()) Builder(items, std::max<size_t>(max_in_leaf, 1), nodes).add(0, items.size());
    return nodes;
}

}  // namespace shvr

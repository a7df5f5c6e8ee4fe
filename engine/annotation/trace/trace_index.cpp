#include "engine/annotation/trace/trace_index.h"

#include <algorithm>
#include <limits>

namespace shvr {

namespace {

double squared(const glm::dvec3& v)
{
    return v.x * v.x + v.y * v.y + v.z * v.z;
}

}  // namespace

void TraceIndex::set(uint32_t number, const glm::dvec3& position)
{
    note(number, position);
}

void TraceIndex::erase(uint32_t number)
{
    note(number, std::nullopt);
}

void TraceIndex::note(uint32_t number, const std::optional<glm::dvec3>& position)
{
    constexpr size_t FEWEST = 256;
    changed_[number] = position;
    if (changed_.size() > std::max(FEWEST, tree_size() / 32)) build();
}

void TraceIndex::build()
{
    auto tree = std::make_shared<Tree>();
    tree->points.reserve(tree_size() + changed_.size());
    if (tree_)
        for (const Point& point : tree_->points)
            if (!changed_.contains(point.number)) tree->points.push_back(point);
    for (const auto& [number, position] : changed_)
        if (position) tree->points.push_back({*position, number});
    changed_.clear();
    tree->axes.assign(tree->points.size(), 0);
    tree->split(0, tree->points.size());
    tree_ = std::move(tree);
}

void TraceIndex::Tree::split(size_t begin, size_t end)
{
    if (begin == end) return;
    glm::dvec3 lower = points[begin].position, upper = lower;
    for (size_t i = begin + 1; i < end; ++i) {
        lower = glm::min(lower, points[i].position);
        upper = glm::max(upper, points[i].position);
    }
    const glm::dvec3 extent = upper - lower;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    const size_t middle = begin + (end - begin) / 2;
    using Offset = std::ptrdiff_t;
    std::nth_element(points.begin() + Offset(begin), points.begin() + Offset(middle), points.begin() + Offset(end),
                     [&](const Point& a, const Point& b) { return a.position[axis] < b.position[axis]; });
    axes[middle] = uint8_t(axis);
    split(begin, middle);
    split(middle + 1, end);
}

/// Visits all points that are at most `most_squared` away, and possibly others. The visitor may decrease `most_squared`
/// during the search.
template <class Visit>
void TraceIndex::search(const glm::dvec3& position, const double& most_squared, const Visit& visit) const
{
    for (const auto& [number, changed] : changed_)
        if (changed) visit(number, squared(*changed - position));
    struct Range {
        size_t begin, end;
        double away_squared;  ///< lower bound, along one axis
    };
    std::vector<Range> ranges{{0, tree_size(), 0.0}};
    while (!ranges.empty()) {
        const Range range = ranges.back();
        ranges.pop_back();
        if (range.begin == range.end || range.away_squared > most_squared) continue;
        const size_t middle = range.begin + (range.end - range.begin) / 2;
        const Point& point = tree_->points[middle];
        if (changed_.empty() || !changed_.contains(point.number))
            visit(point.number, squared(point.position - position));
        const double beyond = position[tree_->axes[middle]] - point.position[tree_->axes[middle]];
        const Range left{range.begin, middle, beyond > 0.0 ? beyond * beyond : 0.0};
        const Range right{middle + 1, range.end, beyond < 0.0 ? beyond * beyond : 0.0};
        // The nearer side is pushed last, so it is searched first and shrinks the search radius for the other side.
        ranges.push_back(beyond > 0.0 ? left : right);
        ranges.push_back(beyond > 0.0 ? right : left);
    }
}

std::optional<uint32_t> TraceIndex::nearest(const glm::dvec3& position, std::optional<uint32_t> except) const
{
    double least = std::numeric_limits<double>::infinity();
    std::optional<uint32_t> found;
    search(position, least, [&](uint32_t number, double away) {
        if (number == except || away > least || (away == least && found && *found < number)) return;
        least = away;
        found = number;
    });
    return found;
}

std::vector<uint32_t> TraceIndex::within(const glm::dvec3& position, double distance) const
{
    std::vector<uint32_t> found;
    const double most = distance * distance;
    search(position, most, [&](uint32_t number, double away) {
        if (away <= most) found.push_back(number);
    });
    std::sort(found.begin(), found.end());
    return found;
}

}  // namespace shvr

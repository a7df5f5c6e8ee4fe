#include "engine/annotation/sets/line_graph.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <unordered_map>

namespace shvr {

namespace {

/// An edge between two touching voxels; a < b.
struct Edge {
    uint32_t a = 0, b = 0;
    double length = 0.0;
};

/// The complex of touching voxels: its edges, shortest first, and its triangles.
class TouchingVoxels {
public:
    TouchingVoxels(const std::vector<Size3>& voxels, const Mask& mask, const glm::dvec3& spacing);
    /// The edges of a graph that has as many parts and loops as the complex.
    std::vector<Edge> spanning(const Progress& progress) const;

private:
    using Column = std::vector<uint32_t>;  ///< edges, ascending
    std::vector<Column> triangles() const;
    std::vector<Edge> edges_{};
    std::vector<std::vector<std::pair<uint32_t, uint32_t>>> later_{};  ///< by vertex: later neighbours and their edges
};

TouchingVoxels::TouchingVoxels(const std::vector<Size3>& voxels, const Mask& mask, const glm::dvec3& spacing)
{
    std::unordered_map<int64_t, uint32_t> places;
    for (uint32_t i = 0; i < voxels.size(); ++i) places.emplace(index_of(voxels[i], mask.size()), i);
    for (uint32_t i = 0; i < voxels.size(); ++i)
        for (int step = 14; step < 27; ++step) {
            const Size3 offset(step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1), at = voxels[i] + offset;
            if (glm::any(glm::lessThan(at, Size3(0))) || glm::any(glm::greaterThanEqual(at, mask.size()))) continue;
            const auto found = places.find(index_of(at, mask.size()));
            if (found == places.end()) continue;
            edges_.push_back({i, found->second, glm::length(glm::dvec3(offset) * spacing)});
        }
    std::ranges::stable_sort(edges_, {}, &Edge::length);
    later_.resize(voxels.size());
    for (uint32_t edge = 0; edge < edges_.size(); ++edge) later_[edges_[edge].a].emplace_back(edges_[edge].b, edge);
    for (auto& later : later_) std::ranges::sort(later);
}

std::vector<TouchingVoxels::Column> TouchingVoxels::triangles() const
{
    std::vector<Column> triangles;
    for (const auto& later : later_)
        for (size_t i = 0; i < later.size(); ++i)
            for (size_t j = i + 1; j < later.size(); ++j) {
                const auto& third = later_[later[i].first];
                const auto found =
                    std::ranges::lower_bound(third, later[j].first, {}, [](const auto& pair) { return pair.first; });
                if (found == third.end() || found->first != later[j].first) continue;
                Column triangle{later[i].second, later[j].second, found->second};
                std::ranges::sort(triangle);
                triangles.push_back(std::move(triangle));
            }
    std::ranges::stable_sort(triangles, {}, [](const Column& triangle) { return triangle.back(); });
    return triangles;
}

/// Reduces the triangles' boundary matrix modulo 2; omits each reduced column's last edge, whose loop triangles fill.
std::vector<Edge> TouchingVoxels::spanning(const Progress& progress) const
{
    std::unordered_map<uint32_t, Column> filled;
    std::vector<Column> columns = triangles();
    for (size_t done = 0; done < columns.size(); ++done) {
        Column& column = columns[done];
        tell(progress, double(done) / double(columns.size()));
        while (!column.empty()) {
            const auto found = filled.find(column.back());
            if (found == filled.end()) break;
            Column sum;
            std::ranges::set_symmetric_difference(column, found->second, std::back_inserter(sum));
            column = std::move(sum);
        }
        if (!column.empty()) filled.emplace(column.back(), std::move(column));
    }
    std::vector<Edge> kept;
    for (uint32_t edge = 0; edge < edges_.size(); ++edge)
        if (!filled.contains(edge)) kept.push_back(edges_[edge]);
    return kept;
}

std::vector<Size3> voxels_of(const BrickSet& set, const Mask& mask)
{
    std::vector<Size3> voxels;
    for (const auto& [brick, bits] : set)
        for (size_t row = 0; row < bits.size(); ++row)
            for (uint32_t left = bits[row]; left != 0; left &= left - 1)
                voxels.push_back(mask.box_of(brick).lower +
                                 Size3(std::countr_zero(left), int64_t(row) % BRICK_SIDE, int64_t(row) / BRICK_SIDE));
    std::ranges::sort(voxels, {}, [&](const Size3& voxel) { return index_of(voxel, mask.size()); });
    return voxels;
}

/// The deviation of a vertex, in position or radius (the larger of the two), from the straight line between two others.
double off_by(const LineGraph::Vertex& vertex, const LineGraph::Vertex& from, const LineGraph::Vertex& to)
{
    const glm::dvec3 way = to.position - from.position, away = vertex.position - from.position;
    const double squared = glm::dot(way, way);
    const double t = squared > 0.0 ? std::clamp(glm::dot(away, way) / squared, 0.0, 1.0) : 0.0;
    return std::max(glm::length(away - t * way), std::abs(vertex.radius - glm::mix(from.radius, to.radius, t)));
}

}  // namespace

LineGraph graph_of(const BrickSet& lines, const Mask& mask, const glm::dvec3& spacing, const Progress& progress)
{
    const std::vector<Size3> voxels = voxels_of(lines, mask);
    LineGraph graph;
    for (const Size3& voxel : voxels) graph.vertices.push_back({.position = (glm::dvec3(voxel) + 0.5) * spacing});
    for (const Edge& edge : TouchingVoxels(voxels, mask, spacing).spanning(progress)) {
        graph.vertices[edge.a].joined.push_back(edge.b);
        graph.vertices[edge.b].joined.push_back(edge.a);
    }
    for (LineGraph::Vertex& vertex : graph.vertices) std::ranges::sort(vertex.joined);
    return graph;
}

int64_t LineGraph::count_edges() const
{
    int64_t ends = 0;
    for (const Vertex& vertex : vertices) ends += int64_t(vertex.joined.size());
    return ends / 2;
}

void LineGraph::remove_edge(uint32_t a, uint32_t b)
{
    std::erase(vertices[a].joined, b);
    std::erase(vertices[b].joined, a);
}

void LineGraph::remove_beyond_first(const Line& line)
{
    for (size_t i = 1; i < line.size(); ++i) {
        remove_edge(line[i - 1], line[i]);
        vertices[line[i]].is_gone = true;
    }
}

LineGraph::Line LineGraph::line_from(uint32_t start, uint32_t next) const
{
    Line line{start, next};
    while (line.back() != start && vertices[line.back()].joined.size() == 2) {
        const std::vector<uint32_t>& joined = vertices[line.back()].joined;
        line.push_back(joined[0] == line[line.size() - 2] ? joined[1] : joined[0]);
    }
    return line;
}

std::vector<LineGraph::Line> LineGraph::lines() const
{
    std::vector<Line> lines;
    std::vector<bool> is_seen(vertices.size());
    for (uint32_t start = 0; start < vertices.size(); ++start) {
        if (vertices[start].joined.size() == 2) continue;
        for (const uint32_t next : vertices[start].joined) {
            Line line = line_from(start, next);
            // Each line is found from both ends.
            if (line.front() > line.back() || (line.front() == line.back() && line[1] > line[line.size() - 2]))
                continue;
            for (const uint32_t vertex : line) is_seen[vertex] = true;
            lines.push_back(std::move(line));
        }
    }
    for (uint32_t start = 0; start < vertices.size(); ++start) {  // loops without a branch
        if (is_seen[start] || vertices[start].joined.size() != 2) continue;
        lines.push_back(line_from(start, vertices[start].joined[0]));
        for (const uint32_t vertex : lines.back()) is_seen[vertex] = true;
    }
    return lines;
}

double LineGraph::length_of(const Line& line) const
{
    double length = 0.0;
    for (size_t i = 1; i < line.size(); ++i)
        length += glm::distance(vertices[line[i - 1]].position, vertices[line[i]].position);
    return length;
}

int64_t LineGraph::prune(double spur)
{
    int64_t pruned = 0;
    for (;;) {
        std::vector<std::pair<double, Line>> spurs;
        for (Line& line : lines()) {
            if (vertices[line.front()].joined.size() == 1) std::ranges::reverse(line);
            const Vertex &branch = vertices[line.front()], &end = vertices[line.back()];
            const double reach = length_of(line) + end.radius;
            if (end.joined.size() == 1 && branch.joined.size() > 2 && reach <= spur * branch.radius)
                spurs.emplace_back(reach, std::move(line));
        }
        std::ranges::stable_sort(spurs, {}, [](const auto& each) { return each.first; });
        const int64_t before = pruned;
        for (const auto& [reach, line] : spurs) {
            if (vertices[line.front()].joined.size() < 3) continue;  // it goes on from there now
            remove_beyond_first(line);
            ++pruned;
        }
        if (pruned == before) return pruned;
    }
}

int64_t LineGraph::drop_collapsed(double within)
{
    int64_t dropped = 0;
    for (;;) {
        const int64_t before = dropped;
        for (Line& line : lines()) {
            if (vertices[line.back()].joined.size() != 1) std::ranges::reverse(line);
            const auto is_near = [&](uint32_t vertex) {
                return glm::distance(vertices[vertex].position, vertices[line.front()].position) <= within;
            };
            if (vertices[line.back()].joined.size() != 1 || !std::ranges::all_of(line, is_near)) continue;
            remove_beyond_first(line);
            ++dropped;
        }
        if (dropped == before) return dropped;
    }
}

void LineGraph::join(uint32_t a, uint32_t b)
{
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
        std::vector<uint32_t>& joined = vertices[from].joined;
        joined.insert(std::ranges::lower_bound(joined, to), to);
    }
}

LineGraph::Line LineGraph::line_to_merge(uint32_t branch, uint32_t next, double tolerance) const
{
    Line line{branch, next};
    const auto is_near = [&] {
        return glm::distance(vertices[branch].position, vertices[line.back()].position) <= tolerance;
    };
    while (vertices[line.back()].joined.size() == 2 && line.back() != branch && is_near()) {
        const std::vector<uint32_t>& joined = vertices[line.back()].joined;
        line.push_back(joined[0] == line[line.size() - 2] ? joined[1] : joined[0]);
    }
    const uint32_t other = line.back();
    if (other == branch || !is_branch(other) || (line.size() > 2 && !is_near())) return {};
    // The branches must not have another edge or a common neighbour: merging would make two edges one and lose a loop.
    const std::vector<uint32_t>&a = vertices[branch].joined, &b = vertices[other].joined;
    std::vector<uint32_t> common;
    std::ranges::set_intersection(a, b, std::back_inserter(common));
    if (line.size() == 3) std::erase(common, line[1]);
    const bool is_joined = line.size() > 2 && std::ranges::binary_search(a, other);
    return common.empty() && !is_joined ? line : Line();
}

void LineGraph::merge(const Line& line)
{
    Vertex &kept = vertices[line.front()], &gone = vertices[line.back()];
    remove_beyond_first(line);
    for (const uint32_t other : std::vector<uint32_t>(gone.joined)) {
        remove_edge(line.back(), other);
        join(line.front(), other);
    }
    if (gone.radius > kept.radius) {
        kept.position = gone.position;
        kept.radius = gone.radius;
    }
}

void LineGraph::merge_branches(double tolerance)
{
    for (uint32_t branch = 0; branch < vertices.size(); ++branch)
        for (size_t i = 0; is_branch(branch) && i < vertices[branch].joined.size();) {
            const Line line = line_to_merge(branch, vertices[branch].joined[i], tolerance);
            ++i;
            if (line.empty()) continue;
            merge(line);
            i = 0;
        }
}

namespace {

/// The line without the vertices inside the balls of branches at its ends.
LineGraph::Line without_ends(const LineGraph& graph, const LineGraph::Line& line)
{
    const auto is_in_ball_of = [&](uint32_t end, uint32_t vertex) {
        const LineGraph::Vertex &ball = graph.vertices[end], &other = graph.vertices[vertex];
        return ball.joined.size() > 2 && glm::distance(ball.position, other.position) < ball.radius;
    };
    size_t first = 1, last = line.size() - 1;
    while (first < last && is_in_ball_of(line.front(), line[first])) ++first;
    while (first < last && is_in_ball_of(line.back(), line[last - 1])) --last;
    LineGraph::Line kept{line.front()};
    kept.insert(kept.end(), line.begin() + int64_t(first), line.begin() + int64_t(last));
    kept.push_back(line.back());
    return kept;
}

}  // namespace

LineGraph::Line simplified(const LineGraph& graph, const LineGraph::Line& whole, double tolerance, size_t inner)
{
    const auto& vertices = graph.vertices;
    const LineGraph::Line between = without_ends(graph, whole), &line = between.size() < inner + 2 ? whole : between;
    // The largest deviation (`off_by`) of a vertex between two places of the line, and that vertex's place.
    const auto worst = [&](size_t first, size_t last) {
        std::pair<double, size_t> most{-1.0, first};
        for (size_t i = first + 1; i < last; ++i) {
            const double off = off_by(vertices[line[i]], vertices[line[first]], vertices[line[last]]);
            if (off > most.first) most = {off, i};
        }
        return most;
    };
    std::set<size_t> kept{0, line.size() - 1};
    std::vector<std::pair<size_t, size_t>> left{{0, line.size() - 1}};
    while (!left.empty()) {
        const auto [first, last] = left.back();
        left.pop_back();
        const auto [off, at] = worst(first, last);
        if (at == first || off <= tolerance) continue;
        kept.insert(at);
        left.emplace_back(first, at);
        left.emplace_back(at, last);
    }
    while (kept.size() < inner + 2 && kept.size() < line.size()) {  // halves the longest piece
        std::pair<size_t, size_t> longest{0, 0};
        for (auto next = std::next(kept.begin()); next != kept.end(); ++next)
            longest = std::max(longest, {*next - *std::prev(next), *std::prev(next)});
        kept.insert(longest.second + longest.first / 2);
    }
    LineGraph::Line result;
    for (const size_t at : kept) result.push_back(line[at]);
    return result;
}

}  // namespace shvr

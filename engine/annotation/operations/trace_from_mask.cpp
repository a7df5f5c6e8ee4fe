// Mask to trace: fills cavities, thins the group to lines (thinning.h), and makes the lines a graph (line_graph.h)
// without spurs, with nodes only where they are needed.

#include <algorithm>
#include <limits>
#include <map>

#include "engine/annotation/operations/group_bricks.h"
#include "engine/annotation/operations/run_operation.h"
#include "engine/annotation/sets/line_graph.h"
#include "engine/annotation/sets/middles.h"
#include "engine/annotation/sets/thinning.h"
#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr {

namespace {

/// Estimated memory for each voxel of the thinned lines: distances cached by Middles (middles.h), and the edges and
/// triangles that join the voxel with others.
constexpr uint64_t BYTES_OF_VERTEX = 4096;

double tolerance_of(const TraceFromMaskOp& op, const glm::dvec3& spacing)
{
    return op.tolerance.value_or(std::max({spacing.x, spacing.y, spacing.z}));
}

struct FilledGroup {
    BrickSet set{};
    int64_t cavities = 0;
};

/// The group with its cavities filled as by `fill_holes`, but without limits and locks, since the mask is not changed.
FilledGroup filled(MaskEdit& edit, uint8_t group, const Progress& progress)
{
    FilledGroup result;
    for_each_brick(edit.mask(), part_of(progress, 0.0, 0.2), [&](int64_t brick) {
        const BrickBits bits = bits_of(edit.read(brick), group);
        if (!is_empty(bits)) result.set.emplace(brick, bits);
    });
    const OperationInput input{.mask = edit.mask(), .volume = edit.input().volume};
    const OperationLimits none;
    MaskEdit filling(input, none);
    perform(FillHolesOp{.group = group}, filling, part_of(progress, 0.2, 1.0));
    for (const MaskBrickChange& change : filling.take().changes) {
        BrickBits& bits = result.set[change.brick];
        for (const MaskRun& run : change.runs)
            for (size_t voxel = run.first; voxel <= run.last; ++voxel) bits[voxel / 32] |= 1u << (voxel % 32);
        for (const MaskRun& run : change.runs) result.cavities += run.last - run.first + 1;
    }
    return result;
}

/// The graph of the group's centre lines, with radii, and the number of spurs removed from it.
struct Lines {
    LineGraph graph{};
    int64_t spurs = 0;
};

/// Thinning removes whole layers, so a line may run off the middle of a tube; its vertices are moved to the middle.
/// Moving changes the distances between neighbouring vertices, so spurs are measured before any vertex moves.
Lines lines_of(const BrickSet& set, const TraceFromMaskOp& op, MaskEdit& edit, const Progress& progress)
{
    const glm::dvec3 spacing = edit.input().volume.spacing;
    const Reach reach{edit.mask(), spacing, 0.0};
    const auto takes = [&](uint64_t bytes) { edit.check_memory(bytes); };
    const BrickSet thin = thinned(set, reach, takes, part_of(progress, 0.0, 0.8));
    uint64_t voxels = 0;
    for (const auto& [brick, bits] : thin) voxels += uint64_t(count_of(bits));
    edit.check_memory(set.size() * sizeof(BrickBits) + voxels * BYTES_OF_VERTEX);
    Lines lines{.graph = graph_of(thin, edit.mask(), spacing, part_of(progress, 0.8, 0.85))};
    std::vector<LineGraph::Vertex>& vertices = lines.graph.vertices;
    Middles middles(set, reach);
    std::vector<glm::dvec3> moved;
    for (LineGraph::Vertex& vertex : vertices) {
        const MiddleBall ball = middles.near(Size3(glm::floor(vertex.position / spacing)));
        moved.push_back(ball.position);
        vertex.radius = ball.radius;
        tell(progress, 0.85 + 0.15 * double(moved.size()) / double(vertices.size()));
    }
    lines.spurs = lines.graph.prune(op.spur);
    for (size_t vertex = 0; vertex < moved.size(); ++vertex) vertices[vertex].position = moved[vertex];
    lines.spurs += lines.graph.drop_collapsed(0.25 * std::min({spacing.x, spacing.y, spacing.z}));
    lines.graph.merge_branches(tolerance_of(op, spacing));
    return lines;
}

/// Collects records that add nodes for the remaining vertices, and internodes between them.
class TraceRecords {
public:
    TraceRecords(const LineGraph& graph, uint8_t group, const TraceGraph* trace) : graph_(graph), group_(group)
    {
        if (!trace) return;
        next_node_ = trace->next_node();
        next_internode_ = trace->next_internode();
    }
    void add(const LineGraph::Line& line)
    {
        for (size_t i = 1; i < line.size(); ++i) {
            const uint32_t a = number_of(line[i - 1]), b = number_of(line[i]);
            internodes_.push_back(TraceInternodeChange{taken(next_internode_), {}, TraceInternode{a, b, group_}});
        }
    }
    uint32_t number_of(uint32_t vertex)
    {
        const auto found = numbers_.find(vertex);
        if (found != numbers_.end()) return found->second;
        const uint32_t number = taken(next_node_);
        const LineGraph::Vertex& at = graph_.vertices[vertex];
        nodes_.push_back(TraceNodeChange{number, {}, TraceNode{at.position, at.radius, group_}});
        return numbers_[vertex] = number;
    }
    size_t nodes() const { return nodes_.size(); }
    size_t internodes() const { return internodes_.size(); }
    std::vector<TraceChange> take()
    {
        std::ranges::move(internodes_, std::back_inserter(nodes_));
        return std::move(nodes_);
    }

private:
    static uint32_t taken(uint64_t& next)
    {
        if (next > std::numeric_limits<uint32_t>::max()) fail("the trace has no more numbers for nodes or internodes");
        return uint32_t(next++);
    }
    const LineGraph& graph_;
    uint8_t group_;
    uint64_t next_node_ = 0, next_internode_ = 0;
    std::map<uint32_t, uint32_t> numbers_{};
    std::vector<TraceChange> nodes_{}, internodes_{};
};

/// Number of nodes needed inside a line: a trace must not join two nodes twice, or a node to itself.
size_t inner_nodes(const LineGraph::Line& line, const std::map<std::pair<uint32_t, uint32_t>, int>& lines_between)
{
    if (line.front() == line.back()) return 2;
    return lines_between.at({line.front(), line.back()}) > 1 ? 1 : 0;
}

void add_lines(const LineGraph& graph, double tolerance, TraceRecords& records)
{
    const std::vector<LineGraph::Line> lines = graph.lines();
    std::map<std::pair<uint32_t, uint32_t>, int> lines_between;
    for (const LineGraph::Line& line : lines) ++lines_between[{line.front(), line.back()}];
    for (uint32_t vertex = 0; vertex < graph.vertices.size(); ++vertex)
        if (graph.vertices[vertex].joined.empty() && !graph.vertices[vertex].is_gone)
            static_cast<void>(records.number_of(vertex));
    for (const LineGraph::Line& line : lines)
        records.add(simplified(graph, line, tolerance, inner_nodes(line, lines_between)));
}

}  // namespace

void perform(const TraceFromMaskOp& op, MaskEdit& edit, const Progress& progress)
{
    const auto group = uint8_t(op.group);
    edit.check_memory(edit.mask().painted_bricks().size() * 2 * sizeof(BrickBits));
    const FilledGroup found = filled(edit, group, part_of(progress, 0.0, 0.2));
    if (found.set.empty()) fail("group ", op.group, " has no voxels; expected some to trace");
    const auto [graph, spurs] = lines_of(found.set, op, edit, part_of(progress, 0.2, 1.0));
    TraceRecords records(graph, group, edit.input().trace);
    add_lines(graph, tolerance_of(op, edit.input().volume.spacing), records);
    edit.note(sentence(
        counted(int64_t(records.nodes()), "node"), " and ", counted(int64_t(records.internodes()), "internode"),
        " were added; ", counted(spurs, "spur"), spurs == 1 ? " was" : " were", " left out",
        found.cavities == 0 ? std::string()
                            : sentence("; cavities of ", counted(found.cavities, "voxel"), " were filled before")));
    edit.change_trace(records.take());
}

}  // namespace shvr

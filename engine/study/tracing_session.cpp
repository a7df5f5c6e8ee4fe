// How a simulated annotator traces: places nodes one after the other along each segment of the plan.

#include <algorithm>
#include <limits>
#include <map>

#include "engine/study/session.h"

namespace shvr {

namespace {

constexpr double NODE_SPACING_M = 0.0054;  ///< 2.8 nodes per segment, as in table 6.1: 515 nodes, 185 segments
constexpr int TRIES = 3;                   ///< to place or select a node
constexpr double OFF_AXIS = 1.2;           ///< in vein radii: a node that looks farther off is placed again

class TracingSession final : public StudySession {
public:
    using StudySession::StudySession;

    void run() override
    {
        for (const PlannedSegment& planned : plan_segments(scene(), random_)) {
            if (desk_.is_over()) return;
            trace(planned);
        }
    }

private:
    void trace(const PlannedSegment& planned)
    {
        const std::vector<glm::dvec3> course = course_of(scene(), planned);
        const std::vector<glm::dvec3> points = points_along(course, NODE_SPACING_M * scene().voxels_per_metre());
        if (look_at(points, scene().vein_radius()) < SEEN_ENOUGH) {
            ++segments_unseen_;
            return;
        }
        std::vector<uint32_t> placed;
        const auto note = [&](std::optional<uint32_t> node) {
            if (node) placed.push_back(*node);
            return node.has_value();
        };
        for (size_t i = 0; i < points.size() && !desk_.is_over(); ++i) {
            const bool is_first = i == 0, is_last = i + 1 == points.size();
            const uint32_t truth = is_first ? planned.nodes.front() : planned.nodes.back();
            think(times_.node);
            if (is_first) {
                if (!note(begin_at(truth, points[i], course))) return;
            } else if (is_last && nodes_.contains(truth)) {
                if (note(join(nodes_.at(truth)))) placed.pop_back();
            } else if (note(add_node(points[i], course)) && is_last) {
                nodes_[truth] = placed.back();
            }
        }
        err(placed);
    }

    double node_radius() const { return input_.skill.node_radii * scene().vein_radius(); }
    std::optional<uint32_t> selected() const { return desk_.document().trace.selection().node(); }
    bool exists(uint32_t node) const { return desk_.document().trace.nodes().contains(node); }

    /// Selects the placed node at an end of the true segment, or places the first node if there is none yet.
    std::optional<uint32_t> begin_at(uint32_t truth, const glm::dvec3& point, std::span<const glm::dvec3> course)
    {
        const auto there = nodes_.find(truth);
        if (there != nodes_.end() && exists(there->second)) {
            if (selected() != there->second) pick(there->second, false);
            return selected();
        }
        desk_.spend(times_.key);
        desk_.edit_trace(DeselectOp{});
        const std::optional<uint32_t> node = add_node(point, course);
        if (node) nodes_[truth] = *node;
        return node;
    }

    /// Reaches for a placed node, and selects it or links it to the selected node.
    bool pick(uint32_t node, bool links)
    {
        const double within = 2.0 * desk_.probe_radius();
        for (int i = 0; i < TRIES && !desk_.is_over(); ++i) {
            const glm::dvec3 target = seen(desk_.document().trace.node(node).position);
            reach(target);
            settle(target);
            desk_.spend(times_.key);
            const glm::dvec3 near = desk_.tool();
            const bool is_done = links
                                     ? desk_.edit_trace(LinkOp{.near = near, .node = {}, .within_voxels = within})
                                     : desk_.edit_trace(SelectOp{.near = near, .number = {}, .within_voxels = within});
            if (!is_done) continue;
            if (links) return true;
            if (selected() == node) return true;
        }
        return false;
    }

    /// Links the selected node to `node`, which closes a loop, and then selects `node`.
    std::optional<uint32_t> join(uint32_t node)
    {
        if (!exists(node) || !pick(node, true)) return std::nullopt;
        desk_.spend(times_.key);
        desk_.edit_trace(SelectOp{.near = {}, .number = node});
        return node;
    }

    /// Places a node linked to the selected one. If the node looks off the vein, undoes it and places it again.
    std::optional<uint32_t> add_node(const glm::dvec3& point, std::span<const glm::dvec3> course)
    {
        for (int i = 0; i < TRIES && !desk_.is_over(); ++i) {
            const glm::dvec3 target = seen(point);
            reach(target);
            settle(target);
            desk_.spend(times_.key);
            const NodeOp op{.at = desk_.tool(), .radius_voxels = node_radius(), .group = {}};
            if (!desk_.edit_trace(op)) continue;
            if (i + 1 == TRIES || looks_right(desk_.document().trace.node(selected().value()).position, course))
                return selected();
            desk_.spend(times_.key);
            desk_.undo();
        }
        return std::nullopt;
    }

    /// Whether a node appears inside the vein, judged across the line of sight only, since depth is not visible.
    bool looks_right(const glm::dvec3& node, std::span<const glm::dvec3> course)
    {
        const glm::dvec3 shown = seen(node);
        double least = std::numeric_limits<double>::max();
        for (size_t i = 1; i < course.size(); ++i) {
            const glm::dvec3 along = course[i] - course[i - 1];
            const double t = glm::clamp(glm::dot(shown - course[i - 1], along) / glm::dot(along, along), 0.0, 1.0);
            const glm::dvec3 off = shown - course[i - 1] - t * along;
            least = std::min(least, glm::length(off - glm::dot(off, view().to_eye) * view().to_eye));
        }
        return least <= OFF_AXIS * scene().vein_radius();
    }

    /// Makes the mistakes that happen at this segment, chosen at random.
    void err(const std::vector<uint32_t>& placed)
    {
        if (placed.size() < 2 || !selected() || desk_.is_over()) return;
        if (placed.size() >= 3 && errs(Mistake::joins_within))
            make_mistake(Mistake::joins_within, LinkOp{.near = {}, .node = placed[placed.size() - 3]});
        const std::optional<uint32_t> distant = distant_node();
        if (distant && errs(Mistake::joins_distant))
            make_mistake(Mistake::joins_distant, LinkOp{.near = {}, .node = *distant});
        const std::optional<glm::dvec3> other = place_on_nearest_bundle();
        if (other && errs(Mistake::joins_bundles))
            make_mistake(Mistake::joins_bundles, NodeOp{.at = *other, .radius_voxels = node_radius(), .group = {}});
    }

    void make_mistake(Mistake mistake, const TraceOp& op)
    {
        const uint64_t before = desk_.document().trace.revision();
        const std::optional<uint32_t> from = selected();
        desk_.spend(times_.mental + times_.key);
        desk_.edit_trace(op);
        if (desk_.document().trace.revision() == before) {
            --mistakes_.made[size_t(mistake)];  // the two were joined already
            return;
        }
        notice(mistake, 1);
        if (from && selected() != from && exists(*from)) desk_.edit_trace(SelectOp{.near = {}, .number = *from});
    }

    std::optional<uint32_t> distant_node()
    {
        const TraceGraph& trace = desk_.document().trace;
        const glm::dvec3 here = trace.node(selected().value()).position;
        std::vector<uint32_t> far;
        for (const auto& [number, node] : trace.nodes())
            if (glm::distance(node.position, here) > 2.0 * NODE_SPACING_M * scene().voxels_per_metre())
                far.push_back(number);
        if (far.empty()) return std::nullopt;
        return far[random_.below(far.size())];
    }

    std::optional<glm::dvec3> place_on_nearest_bundle() const
    {
        const glm::dvec3 here = desk_.document().trace.node(desk_.document().trace.selection().node().value()).position;
        std::optional<glm::dvec3> best;
        for (const SeparateBundle& bundle : scene().separate_bundles())
            for (const glm::dvec3& at : bundle.course)
                if (!best || glm::distance(at, here) < glm::distance(*best, here)) best = at;
        return best;
    }

    std::map<uint32_t, uint32_t> nodes_;  ///< node of the true trace -> the node placed there
};

}  // namespace

std::unique_ptr<StudySession> make_tracing_session(const StudySessionInput& input)
{
    return std::make_unique<TracingSession>(input);
}

}  // namespace shvr

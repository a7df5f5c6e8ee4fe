#include "engine/workbench/services/tracer.h"

#include <algorithm>

#include "engine/session/words/number_words.h"
#include "engine/workbench/desk/declined.h"
#include "engine/workbench/edits/edit.h"
#include "engine/workbench/edits/trace_ops.h"
#include "engine/workbench/words/trace_words.h"

namespace shvr::ui {

namespace {

/// Returns the two neighbours of the selected node if only this node connects them, so that deleting it cuts the trace.
std::optional<std::pair<uint32_t, uint32_t>> ends_of_cut(const TraceGraph& trace)
{
    const std::optional<uint32_t> node = trace.selection().node();
    if (!node || trace.internodes_of(*node).size() != 2) return std::nullopt;
    const auto internodes = trace.internodes_of(*node);
    const std::pair ends(trace.internode(internodes[0]).other(*node), trace.internode(internodes[1]).other(*node));
    return trace.internode_between(ends.first, ends.second) ? std::nullopt : std::optional(ends);
}

/// Returns whether the selected node lies outside the volume, which is permitted up to some distance.
bool lies_outside(const TraceGraph& trace, const VolumeInfo& volume)
{
    const std::optional<uint32_t> node = trace.selection().node();
    if (!node) return false;
    const glm::dvec3 voxel = trace.node(*node).position / volume.spacing;
    return glm::any(glm::lessThan(voxel, glm::dvec3(0.0))) ||
           glm::any(glm::greaterThan(voxel, glm::dvec3(volume.size)));
}

/// From the eye to a point.
glm::dvec3 sight_through(const Camera& camera, const glm::dvec3& point)
{
    return camera.projection == Camera::Projection::perspective ? point - camera.eye : axes_of(camera).forward;
}

}  // namespace

Tracer::Tracer(Desk& desk, PreferenceKeeper& keeper, Others others)
    : Service(desk), keeper_(keeper), others_(std::move(others))
{}

/// Gives a new node the radius of the structure around it, if settings ask for that and the radius can be measured.
TraceOp Tracer::with_radius(TraceOp op) const
{
    NodeOp* const node = std::get_if<NodeOp>(&op);
    const ServoState* const servo = document_->touch.servo();
    if (node && !node->radius_voxels && document_->session.probe.touch.overlap_radius && servo &&
        servo->step.in_contact)
        if (const auto radius = radius_from_overlap(servo->step.relevant_share, document_->probe_radius()))
            node->radius_voxels = *radius / document_->volume().spacing.x;
    if (node && !node->radius_voxels && document_->session.probe.measured_radius)
        if (const auto ball = document_->ball_at(node->at))
            node->radius_voxels = ball->radius / document_->volume().spacing.x;
    return op;
}

void Tracer::trace(const TraceOp& asked)
{
    const TraceOp op = options_.is_script ? asked : with_radius(asked);
    Annotator& annotator = document_->annotator;
    if (annotator.stroke_is_running()) decline("The trace cannot be edited while a stroke is being painted");
    const TraceGraph& trace = annotator.document().trace;
    if (const NodeOp* node = std::get_if<NodeOp>(&op);
        node && node->group.value_or(node->divides ? uint8_t(1) : document_->brush().group) == 0)
        decline("Group 0 is the eraser; choose a group from 1 up for the node");
    if (const GroupOp* group = std::get_if<GroupOp>(&op); group && group->group == 0)
        decline("Group 0 is the eraser, and traces belong to a group from 1 up");
    others_.record_settings();
    const TraceSize before{trace.nodes().size(), trace.internodes().size()};
    const auto cut = std::holds_alternative<DeleteOp>(op) ? ends_of_cut(trace) : std::nullopt;
    TraceEffect effect = effect_of(op, trace, document_->trace_defaults());
    if (effect.selection) annotator.work().select_trace(*effect.selection);
    const Command* const done = annotator.edit_trace(std::move(effect.label), std::move(effect.changes));
    document_->drags_node = false;
    if (done) others_.show_changes(*done);
    if (cut && done && !options_.is_script) return note_cut(cut);
    const std::string said = said_of(op, effect.selection.has_value(), done, trace, before);
    const bool places = std::holds_alternative<NodeOp>(op) || std::holds_alternative<MoveOp>(op);
    if (done && places && lies_outside(trace, document_->volume()))
        return say(said + "; it lies outside the volume", Weight::warning);
    say(said);
}

/// Remembers the two ends of a cut, and selects one of them, so that tracing continues there.
void Tracer::note_cut(std::optional<std::pair<uint32_t, uint32_t>> ends)
{
    document_->cut_ends = ends;
    document_->annotator.work().select_trace({{ends->first}, {}});
    const std::string keys = keeper_.keys_of("mend_cut");
    say(sentence("Deleted; the trace is cut between node ", ends->first, ", which is selected, and node ", ends->second,
                 keys.empty() ? "; Trace > Mend the cut links them" : "; " + keys + " links them"));
}

void Tracer::act(const MendCut&)
{
    if (!document_->is_cut()) fail("the last deletion cut nothing in two; expected two nodes to link again");
    const auto [from, to] = *document_->cut_ends;
    const TraceSelection before = document_->annotator.document().trace.selection();
    document_->annotator.work().select_trace({{from}, {}});
    try {
        trace(LinkOp{.near = {}, .node = to});
    } catch (...) {
        document_->annotator.work().select_trace(before);
        throw;
    }
    document_->cut_ends.reset();
}

/// Returns the node nearest to a point, if the distance is at most half of a voxel's diagonal.
std::optional<uint32_t> Tracer::node_in_voxel(const glm::dvec3& voxel) const
{
    const glm::dvec3& spacing = document_->volume().spacing;
    const TraceGraph& trace = document_->annotator.document().trace;
    return nearest_node_of(trace, groups_found_nearby(document_->session), voxel * spacing, 0.5 * glm::length(spacing));
}

/// Returns the point under a pixel on a centre line, if tools snap to lines. Lines of the selected node count, too.
std::optional<ToolPlace> Tracer::line_at(const Pane& seen, const glm::dvec2& pixel) const
{
    if (!document_->session.probe.touch.to_lines) return std::nullopt;
    const TraceGraph& trace = document_->annotator.document().trace;
    const TraceHit hit = trace_hit(trace, seen, pixel, document_->volume(), groups_in_pane(document_->session, seen));
    if (!hit.internode || is_hidden(seen, pixel, hit)) return std::nullopt;
    const TraceInternode& internode = trace.internode(*hit.internode);
    const glm::dvec3 there = unproject(seen.shot.camera, seen.pixels(), pixel, hit.depth);
    const glm::dvec3 way = glm::normalize(sight_through(seen.shot.camera, there));
    const glm::dvec3 a = trace.node(internode.a).position, b = trace.node(internode.b).position;
    // Find the point of the centre line that is nearest to the line of sight.
    const auto across = [&](const glm::dvec3& v) { return v - way * glm::dot(v, way); };
    const glm::dvec3 begin = across(a - there), along = across(b - a);
    const double square = glm::dot(along, along);
    const double share = square > 0.0 ? glm::clamp(-glm::dot(begin, along) / square, 0.0, 1.0) : 0.5;
    return ToolPlace{glm::mix(a, b, share), {}, hit.internode};
}

/// If the tools snap to part of the trace at `place`, carries out the operation on this part, and returns true.
bool Tracer::add_drawn_node(const ToolPlace& place)
{
    const glm::dvec3& spacing = document_->volume().spacing;
    const auto op = trace_op_at(place, document_->annotator.document().trace, spacing);
    if (!op) return false;
    Actions done = add_node_at(*op);
    others_.move_probe(place.point, false);
    done.push_back(PlaceProbe{place.point / spacing});
    log_instead(done);
    return true;
}

/// Adds a node at the visible point. If `centered_nodes` is set, adds it in the middle of the structure that the line
/// of sight enters there; in slices, always at the point that was clicked.
void Tracer::act(const NodeAt& action)
{
    const Pane seen = others_.pane(action.pane);
    if (const auto line = line_at(seen, action.pixel)) {
        add_drawn_node(*line);
        return;
    }
    const std::optional<glm::dvec3> point = others_.seen_at(seen, action.pixel);
    if (!point) decline("Nothing is seen there, so no node is added; click something visible");
    glm::dvec3 voxel = *point / document_->volume().spacing;
    const bool goes_inside = document_->session.probe.centered_nodes && !seen.shot.is_slice;
    const std::optional<LocalBall> ball =
        goes_inside ? document_->ball_at(voxel, sight_through(seen.shot.camera, *point)) : std::nullopt;
    if (ball) voxel = ball->middle;
    const glm::dvec3& spacing = document_->volume().spacing;
    if (add_drawn_node(document_->tool_place_at(voxel * spacing))) return;
    if (const auto there = ball ? node_in_voxel(voxel) : std::nullopt) {
        const SelectOp selecting{.near = {}, .number = there, .within_voxels = {}};
        trace(selecting);
        say(sentence("Node ", *there, " lies in the middle of that already, and is selected"));
        return log_instead({selecting});
    }
    trace(NodeOp{.at = voxel, .radius_voxels = {}, .group = {}});
    if (goes_inside && !ball)
        say(desk_.messages.last() +
                "; it stays on the surface, for nothing there has a middle above the paint threshold " +
                sentence(number_in_words(*document_->brush().threshold),
                         keeper_.with_key("; ", "threshold_here", " sets the threshold from here")),
            Weight::warning);
    if (ball && ball->is_held)
        say(desk_.messages.last() +
            "; it is not in the middle, which lies further aside than the probe's radius: a larger probe finds it");
    others_.move_probe(voxel * spacing, false);
    log_instead({NodeOp{.at = voxel, .radius_voxels = {}, .group = {}}, PlaceProbe{voxel}});
}

void Tracer::act(const SelectAt& action)
{
    Document& document = *document_;
    if (document.annotator.stroke_is_running()) decline("Nothing can be selected while a stroke is being painted");
    const Pane seen = others_.pane(action.pane);
    const TraceGraph& trace = document.annotator.document().trace;
    const TraceHit hit =
        trace_hit(trace, seen, action.pixel, document.volume(), groups_in_pane(document.session, seen), SPARE_PIXELS);
    if ((hit.node || hit.internode) && !is_hidden(seen, action.pixel, hit)) {
        this->trace(SelectOp{
            .near = {}, .number = hit.node ? hit.node : hit.internode, .is_internode = !hit.node, .within_voxels = {}});
        if (action.whole_segment) select_segment();
        return;
    }
    const std::optional<glm::dvec3> point = others_.seen_at(seen, action.pixel);
    const glm::dvec3 voxel = point ? *point / document.volume().spacing : glm::dvec3(-1.0);
    const bool is_inside = glm::all(glm::greaterThanEqual(voxel, glm::dvec3(0.0))) &&
                           glm::all(glm::lessThan(voxel, glm::dvec3(document.volume().size)));
    const uint8_t group = is_inside ? document.annotator.document().mask.at(Size3(glm::floor(voxel))) : uint8_t(0);
    if (group == 0) {
        if (!trace.selection().empty()) this->trace(DeselectOp{});
        return;
    }
    if (group == document.brush().group) return say(sentence("Group ", int(group), " is the active group already"));
    others_.set(edited(document.session, [&](Session& s) { s.probe.brush.group = group; }));
}

/// Extends the selection to the segment of the selected part. A node in several segments, or in none, stays selected.
void Tracer::select_segment()
{
    try {
        trace(SelectSegmentOp{});
    } catch (const Error& error) {
        say(error.what());
    }
}

/// Returns whether the volume hides the trace at this pixel. Surfaces generated from the trace itself do not hide it.
bool Tracer::is_hidden(const Pane& seen, const glm::dvec2& pixel, const TraceHit& hit) const
{
    constexpr double OPAQUE_ENOUGH = 0.9, APART_VOXELS = 2.0;
    if (seen.shot.is_slice) return false;
    const glm::dvec3& spacing = document_->volume().spacing;
    const double apart = hit.radius + APART_VOXELS * std::max({spacing.x, spacing.y, spacing.z});
    Camera camera = seen.shot.camera;
    camera.far_distance = hit.depth - apart;
    if (camera.far_distance <= camera.near_distance) return false;
    const glm::uvec2 at = glm::uvec2(glm::clamp(pixel, glm::dvec2(0.0), glm::dvec2(seen.pixels() - 1u)));
    const auto before = renderer_.pick(document_->session.look(), camera, seen.pixels(), at, document_->probe_look());
    if (!before || before->opacity < OPAQUE_ENOUGH) return false;
    const TraceGraph& trace = document_->annotator.document().trace;
    const auto is_of_trace = [&](uint32_t number) {
        const TraceInternode& internode = trace.internode(number);
        return distance_to(trace, internode, before->point) < trace.radius_of(internode, 0.5) + apart;
    };
    return hit.node ? std::ranges::none_of(trace.internodes_of(*hit.node), is_of_trace) : !is_of_trace(*hit.internode);
}

void Tracer::act(const StepNode& action)
{
    Document& document = *document_;
    const TraceGraph& trace = document.annotator.document().trace;
    if (trace.nodes().empty()) fail("there is no node; expected one to look at");
    const std::optional<uint32_t> selected = trace.selection().node();
    const std::bitset<256> groups = document.trace_defaults().found;
    const auto step = [&](auto from) {
        if (action.back) return std::prev(from == trace.nodes().begin() ? trace.nodes().end() : from);
        if (from != trace.nodes().end()) ++from;
        return from == trace.nodes().end() ? trace.nodes().begin() : from;
    };
    auto at = step(selected ? trace.nodes().find(*selected) : trace.nodes().end());
    for (size_t tried = 1; !groups[at->second.group] && tried < trace.nodes().size(); ++tried) at = step(at);
    if (!groups[at->second.group])
        fail(
            "all nodes of the trace are in hidden groups; expected one to look at: show a group, or feel hidden parts");
    const glm::dvec3 position = at->second.position;
    this->trace(SelectOp{.near = {}, .number = at->first, .within_voxels = {}});
    Camera camera = document.camera;
    camera.eye += position - camera.target;
    camera.target = position;
    others_.look_from(camera);
    others_.move_probe(position, true);
}

void Tracer::act(const DragNode& action)
{
    const TraceGraph& trace = document_->annotator.document().trace;
    if (action.on) {
        const std::optional<uint32_t> node = trace.selection().node();
        if (document_->annotator.stroke_is_running())
            fail("The trace cannot be edited while a stroke is being painted");
        if (trace.selection().empty()) fail("Nothing is selected; select a node or a segment to move it");
        document_->drags_node = true;
        document_->drag_from = document_->tool_voxel();  // which nothing attracts while that is set
        return say(sentence(node ? sentence("Node ", *node, " follows") : "What is selected moves with",
                            " the probe until the key or the button is released"));
    }
    if (document_->drags_node) this->trace(document_->drag_move());
}

/// Adds a node where tools act. If they snap to an existing node, links the selected node to it and selects it.
void Tracer::add_node_here()
{
    add_node_at(node_or_link_at_probe(desk_.model()));
}

/// Returns what was done.
Actions Tracer::add_node_at(const Action& action)
{
    if (const auto* node = action.as<NodeOp>()) {
        trace(*node);
        return {action};
    }
    Actions done{action};
    if (const auto* link = action.as<LinkOp>()) {
        trace(*link);
        done.push_back(SelectOp{.near = {}, .number = link->node, .within_voxels = {}});
    }
    trace(*done.back().as<SelectOp>());
    return done;
}

TraceModel Tracer::model() const
{
    if (!document_) return {.trace = desk_.nothing.trace};
    return {.trace = document_->annotator.document().trace,
            .nearby_node = document_->nearby_node(),
            .drags_node = document_->drags_node,
            .is_cut = document_->is_cut()};
}

}  // namespace shvr::ui

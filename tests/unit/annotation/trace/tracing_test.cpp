#include "engine/annotation/trace/tracing.h"

#include <algorithm>
#include <bit>
#include <random>
#include <string>

#include <doctest/doctest.h>

#include "engine/annotation/trace/trace_edit.h"
#include "engine/annotation/work/history.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// A document, its history, and the user's commands.
struct Desk {
    Document document{Mask({8, 8, 8}), {}};
    History history;

    TraceGraph& trace() { return document.trace; }
    void perform(std::vector<TraceChange> changes)
    {
        history.perform(document, {"command", {changes.begin(), changes.end()}});
    }
    uint32_t add(const glm::dvec3& position, double radius = 1.0, uint8_t group = 1)
    {
        perform(add_node(trace(), {position, radius, group}));
        return trace().selection().node().value();
    }
    void select(uint32_t node) { trace().select({{node}, {}}); }
    void deselect() { trace().select({}); }
    uint32_t link(uint32_t a, uint32_t b)
    {
        select(a);
        perform(link_selected(trace(), b));
        return trace().internode_between(a, b).value();
    }
};

/// The complete annotation, bit for bit.
std::vector<uint64_t> bits_of(const TraceGraph& trace)
{
    std::vector<uint64_t> bits;
    for (const auto& [number, node] : trace.nodes()) {
        bits.insert(bits.end(), {number, node.group, std::bit_cast<uint64_t>(node.radius)});
        for (int axis = 0; axis < 3; ++axis) bits.push_back(std::bit_cast<uint64_t>(node.position[axis]));
    }
    for (const auto& [number, internode] : trace.internodes())
        bits.insert(bits.end(), {number, internode.a, internode.b, internode.group});
    for (const auto& [group, radius] : trace.internode_radii())
        bits.insert(bits.end(), {group, std::bit_cast<uint64_t>(radius)});
    return bits;
}

/// A Y: 0 - 1 - 2, and from 2 the arms 3 - 4 and 5.
void draw_y(Desk& desk)
{
    desk.add({0, 0, 0});
    desk.add({1, 0, 0});
    desk.add({2, 0, 0});
    desk.add({3, 1, 0});
    desk.add({4, 2, 0});
    desk.select(2);
    desk.add({3, -1, 0});
}

}  // namespace

TEST_CASE("a node is added, selected, and joined to the one that was selected")
{
    Desk desk;
    CHECK(desk.add({1, 2, 3}, 2.5, 7) == 0);
    CHECK(desk.trace().node(0) == TraceNode{{1, 2, 3}, 2.5, 7});
    CHECK(desk.trace().internodes().empty());
    CHECK(desk.add({2, 2, 3}, 1.5, 9) == 1);
    CHECK(desk.trace().internode(0) == TraceInternode{0, 1, 9});
    desk.deselect();
    CHECK(desk.add({9, 9, 9}) == 2);
    CHECK(desk.trace().internodes().size() == 1);
}

TEST_CASE("undoing and redoing an addition brings back what was selected")
{
    Desk desk;
    desk.add({0, 0, 0});
    desk.add({1, 0, 0});
    desk.history.undo(desk.document);
    CHECK(desk.trace().selection() == TraceSelection{{0}, {}});
    CHECK(desk.trace().nodes().size() == 1);
    CHECK(desk.trace().internodes().empty());
    desk.history.redo(desk.document);
    CHECK(desk.trace().selection() == TraceSelection{{1}, {}});
    CHECK(desk.trace().internodes().size() == 1);
}

TEST_CASE("numbers are not given again after an undo")
{
    Desk desk;
    desk.add({0, 0, 0});
    desk.add({1, 0, 0});
    desk.history.undo(desk.document);
    CHECK(desk.add({2, 0, 0}) == 2);
    CHECK(desk.trace().internodes().begin()->first == 1);
}

TEST_CASE("the last number is given, and then none")
{
    Desk desk;
    desk.trace().reserve_numbers((uint64_t{1} << 32) - 1, 0);
    CHECK(desk.add({0, 0, 0}) == 4294967295u);
    CHECK(error_of([&] { desk.add({1, 0, 0}); }).find("no number is left") == 0);
}

TEST_CASE("a node is moved, and moved back")
{
    Desk desk;
    desk.add({0, 0, 0});
    desk.add({1, 0, 0});
    desk.perform(move_selected(desk.trace(), {-5, 6, 7}));
    CHECK(desk.trace().node(1).position == glm::dvec3(-5, 6, 7));
    CHECK(desk.trace().nearest_node({-5, 6, 6}) == 1u);  // at its old position the other one would be nearer
    desk.history.undo(desk.document);
    CHECK(desk.trace().node(1).position == glm::dvec3(1, 0, 0));
    CHECK(desk.trace().nearest_node({-5, 6, 6}) == 0u);
    CHECK(desk.trace().nearest_node({0.6, 0, 0}) == 1u);
    CHECK(move_selected(desk.trace(), {1, 0, 0}).empty());
}

TEST_CASE("two nodes are linked once, and none with itself")
{
    Desk desk;
    for (int i = 0; i < 3; ++i) desk.add({double(i), 0, 0});
    desk.perform(link_selected(desk.trace(), 0));
    CHECK(desk.trace().internodes().size() == 3);  // a loop
    CHECK(desk.trace().selection().node() == 2u);
    CHECK(error_of([&] { link_selected(desk.trace(), 0); }) ==
          "nodes 2 and 0 are already linked; expected two that are not");
    desk.select(0);
    CHECK(error_of([&] { link_selected(desk.trace(), 2); }) ==
          "nodes 0 and 2 are already linked; expected two that are not");
    CHECK(error_of([&] { link_selected(desk.trace(), 0); }) ==
          "node 0 cannot be linked to itself; expected another node");
}

TEST_CASE("a node is deleted with its internodes, and comes back selected")
{
    Desk desk;
    draw_y(desk);
    const auto before = bits_of(desk.trace());
    desk.select(2);
    desk.perform(delete_selected(desk.trace()));
    CHECK(desk.trace().nodes().size() == 5);
    CHECK(desk.trace().internodes().size() == 2);
    CHECK(desk.trace().selection().empty());
    desk.history.undo(desk.document);
    CHECK((bits_of(desk.trace()) == before));
    CHECK(desk.trace().selection().node() == 2u);
    desk.history.redo(desk.document);
    CHECK(desk.trace().nodes().size() == 5);
}

TEST_CASE("an internode of the selected node is selected, deleted and brought back")
{
    Desk desk;
    draw_y(desk);
    desk.select(2);
    desk.trace().select(nearest_internode_selection(desk.trace(), {2.6, 0.9, 0}));
    const uint32_t arm = desk.trace().selection().internode().value();
    CHECK(desk.trace().internode(arm) == TraceInternode{2, 3, 1});
    desk.perform(delete_selected(desk.trace()));
    CHECK(desk.trace().nodes().size() == 6);
    CHECK(!desk.trace().internode_between(2, 3));
    desk.history.undo(desk.document);
    CHECK(desk.trace().selection().internode() == arm);
}

TEST_CASE("what is removed is no longer selected")
{
    Desk desk;
    for (int i = 0; i < 3; ++i) desk.add({double(i), 0, 0});
    desk.perform(link_selected(desk.trace(), 0));
    desk.trace().select({{}, {2}});
    desk.history.undo(desk.document);
    CHECK(desk.trace().selection().empty());
    desk.deselect();
    desk.add({9, 9, 9});
    desk.trace().apply(TraceNodeChange{3, desk.trace().node(3), {}}, Direction::forwards);
    CHECK(desk.trace().selection().empty());
}

TEST_CASE("groups of nodes, of internodes and of segments are changed")
{
    Desk desk;
    draw_y(desk);
    desk.select(3);
    desk.perform(set_group_of_selected(desk.trace(), 4));
    CHECK(desk.trace().node(3).group == 4);
    desk.trace().select({{}, {0}});
    desk.perform(set_group_of_selected(desk.trace(), 5));
    CHECK(desk.trace().internode(0).group == 5);
    CHECK(set_group_of_selected(desk.trace(), 5).empty());

    desk.trace().select(segment_selection(desk.trace()));
    CHECK((desk.trace().selection() == TraceSelection{{0, 1}, {0, 1}}));  // the branch, node 2, is not the segment's
    desk.perform(set_group_of_selected(desk.trace(), 6));
    CHECK(desk.trace().node(0).group == 6);
    CHECK(desk.trace().node(1).group == 6);
    CHECK(desk.trace().node(2).group == 1);
    CHECK(desk.trace().internode(1).group == 6);
    desk.history.undo(desk.document);
    CHECK(desk.trace().internode(0).group == 5);
    CHECK(desk.trace().internode(1).group == 1);
}

TEST_CASE("sizes are set for a node, a segment, the nodes of a group and the internodes of a group")
{
    Desk desk;
    draw_y(desk);
    desk.select(0);
    desk.perform(set_radius_of_selected(desk.trace(), 3.0));
    CHECK(desk.trace().radius_of(desk.trace().internode(0), 0.25) == 2.5);
    desk.trace().select(segment_selection(desk.trace()));
    desk.perform(set_radius_of_selected(desk.trace(), 2.0));
    CHECK(desk.trace().node(1).radius == 2.0);
    CHECK(desk.trace().node(2).radius == 1.0);
    desk.select(5);
    desk.perform(set_group_of_selected(desk.trace(), 2));
    desk.perform(set_node_radii(desk.trace(), 1, 7.0));
    CHECK(desk.trace().node(0).radius == 7.0);
    CHECK(desk.trace().node(5).radius == 1.0);

    desk.perform(set_internode_radius(desk.trace(), 1, 0.5));
    CHECK(desk.trace().radius_of(desk.trace().internode(0), 0.25) == 0.5);
    CHECK(set_internode_radius(desk.trace(), 1, 0.5).empty());
    desk.perform(set_internode_radius(desk.trace(), 1, std::nullopt));
    CHECK(desk.trace().radius_of(desk.trace().internode(0), 0.25) == 7.0);
    desk.history.undo(desk.document);
    CHECK(desk.trace().internode_radii().at(1) == 0.5);
}

TEST_CASE("deleting a segment leaves its branches")
{
    Desk desk;
    draw_y(desk);
    desk.select(4);
    desk.trace().select(segment_selection(desk.trace()));
    desk.perform(delete_selected(desk.trace()));
    CHECK(desk.trace().nodes().size() == 4);
    CHECK(desk.trace().nodes().contains(2));
    CHECK(segments_of(desk.trace()).size() == 1);  // the former branch is none any more
    desk.history.undo(desk.document);
    CHECK(segments_of(desk.trace()).size() == 3);
}

TEST_CASE("segments end at branches and ends, and loops are segments")
{
    Desk desk;
    draw_y(desk);
    desk.link(4, 5);  // now a loop hangs on the branch
    const std::vector<TraceSegment> segments = segments_of(desk.trace());
    REQUIRE(segments.size() == 2);
    CHECK((segments[0].nodes == std::vector<uint32_t>{0, 1, 2}));
    CHECK(segments[1].is_loop());
    CHECK(segments[1].nodes.front() == 2);
    CHECK(segments[1].internodes.size() == 4);

    Desk ring;  // with no branch at all
    for (int i = 0; i < 5; ++i) ring.add({double(i), double(i * i), 0});
    ring.link(4, 0);
    REQUIRE(segments_of(ring.trace()).size() == 1);
    CHECK(segments_of(ring.trace())[0].is_loop());
    CHECK(segments_of(ring.trace())[0].internodes.size() == 5);
    CHECK(selection_of(ring.trace(), segments_of(ring.trace())[0]).nodes.size() == 5);
    CHECK(segments_of(ring.trace(), {2, 4}).size() == 2);
    REQUIRE(segments_of(ring.trace(), {2}).size() == 1);
    CHECK(segments_of(ring.trace(), {2})[0].nodes.front() == 2);
}

TEST_CASE("what cannot be done is said in words")
{
    Desk desk;
    const auto refusal = [&](auto&& act) { return error_of([&] { act(desk.trace()); }); };
    CHECK(refusal([](auto& t) { move_selected(t, {}); }) == "nothing is selected; expected a node");
    CHECK(refusal([](auto& t) { delete_selected(t); }) ==
          "nothing is selected; expected a node, an internode or a segment");
    CHECK(refusal([](auto& t) { nearest_node_selection(t, {}); }) == "the trace has no nodes; expected one to select");
    draw_y(desk);
    desk.select(2);
    CHECK(refusal([](auto& t) { segment_selection(t); }).find("node 2 is a branch of 3 internodes") == 0);
    desk.trace().select({{}, {0}});
    CHECK(refusal([](auto& t) { move_selected(t, {}); }) == "no node is selected; expected a node");
    CHECK(refusal([](auto& t) { set_radius_of_selected(t, 1); }).find("only internodes are selected") == 0);
    desk.deselect();
    desk.add({50, 50, 50});
    CHECK(refusal([](auto& t) { segment_selection(t); }) == "node 6 has no internodes; expected one on a segment");
}

TEST_CASE("5000 random commands with undo and redo: every state is, bit for bit, the one that was there")
{
    for (const uint32_t seed : {1u, 2u}) {
        CAPTURE(seed);
        std::mt19937 random(seed);
        const auto uniform = [&] { return std::uniform_real_distribution<double>(-10.0, 10.0)(random); };
        Desk desk;
        std::vector<std::vector<uint64_t>> states{bits_of(desk.trace())};
        size_t at = 0, wrong = 0, doubled = 0;
        std::array<int, 10> done{};
        for (int step = 0; step < 5000; ++step) {
            TraceGraph& trace = desk.trace();
            const glm::dvec3 where(uniform(), uniform(), uniform());
            const auto what = random() % 16;
            if (what == 0) at -= desk.history.undo(desk.document) != nullptr;
            if (what == 1) at += desk.history.redo(desk.document) != nullptr;
            if (what == 2) trace.select({});
            if (what < 3) {
                wrong += bits_of(trace) != states[at];
                continue;
            }
            std::vector<TraceChange> changes;
            try {
                const uint32_t near = trace.nearest_node(where).value_or(0);
                if (what == 3) trace.select(nearest_node_selection(trace, where));
                if (what == 4) trace.select(nearest_internode_selection(trace, where));
                if (what == 5) trace.select(segment_selection(trace));
                if (what == 6) changes = delete_selected(trace);
                if (what == 7 || what == 8) changes = link_selected(trace, near);
                if (what == 9) changes = move_selected(trace, where);
                if (what == 10) changes = set_group_of_selected(trace, uint8_t(random() % 4));
                if (what == 11) changes = set_radius_of_selected(trace, std::abs(uniform()));
                if (what == 12) changes = set_node_radii(trace, uint8_t(random() % 4), std::abs(uniform()));
                if (what == 13)
                    changes = set_internode_radius(trace, uint8_t(random() % 4),
                                                   random() % 2 ? std::optional(uniform() + 10.0) : std::nullopt);
                if (what > 13) changes = add_node(trace, {where, std::abs(uniform()), uint8_t(random() % 4)});
            } catch (const Error&) {
                continue;
            }
            if (changes.empty()) continue;
            ++done[std::min<size_t>(what - 6, 8)];
            desk.perform(std::move(changes));
            states.resize(++at);
            states.push_back(bits_of(trace));
            std::set<std::pair<uint32_t, uint32_t>> pairs;
            for (const auto& [number, internode] : trace.internodes())
                doubled += internode.a == internode.b || !pairs.insert(std::minmax(internode.a, internode.b)).second;
        }
        CHECK(wrong == 0);
        CHECK(doubled == 0);
        for (size_t kind = 0; kind < 9; ++kind) CHECK(done[kind] > 10);

        while (desk.history.redo(desk.document)) ++at;
        CHECK(at + 1 == states.size());
        CHECK((bits_of(desk.trace()) == states.back()));
        while (desk.history.undo(desk.document)) wrong += bits_of(desk.trace()) != states[--at];
        CHECK(wrong == 0);
        CHECK(desk.trace().nodes().empty());
        CHECK(desk.trace().selection().empty());
    }
}

TEST_CASE("one command may hold voxels and nodes")
{
    Desk desk;
    Command command{"both", {MaskBrickChange{.brick = 0, .runs = {{0, 3, 0, 2}}}}};
    for (TraceChange& change : add_node(desk.trace(), {{1, 1, 1}, 1.0, 2})) command.changes.emplace_back(change);
    desk.history.perform(desk.document, command);
    CHECK(desk.document.mask.at({2, 0, 0}) == 2);
    CHECK(desk.trace().nodes().size() == 1);
    desk.history.undo(desk.document);
    CHECK(desk.document.mask.painted_bricks().empty());
    CHECK(desk.trace().nodes().empty());
}

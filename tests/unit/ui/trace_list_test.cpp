// A trace as lists: their content and order, and that they are made once for each state of the trace.

#include "engine/workbench/lists/trace_list.h"

#include <doctest/doctest.h>

using namespace shvr;
using namespace shvr::ui;

namespace {

/// A chain 0-1-2 of group 1, and from 2 two branches: 2-3 of group 2, and 2-4-5 of groups 2 and 3.
TraceGraph tree()
{
    TraceGraph trace;
    const glm::dvec3 places[] = {{0, 0, 0}, {2, 0, 0}, {4, 0, 0}, {4, 1, 0}, {5, 0, 0}, {5, 0, 6}};
    for (uint32_t node = 0; node < 6; ++node)
        trace.apply(TraceNodeChange{node, {}, TraceNode{places[node], 1.0, 1}}, Direction::forwards);
    const TraceInternode internodes[] = {{0, 1, 1}, {1, 2, 1}, {2, 3, 2}, {2, 4, 2}, {4, 5, 3}};
    for (uint32_t internode = 0; internode < 5; ++internode)
        trace.apply(TraceInternodeChange{internode, {}, internodes[internode]}, Direction::forwards);
    return trace;
}

std::string order_of(const TraceList& list)
{
    std::string text;
    for (const SegmentRow& row : list.segments()) text += (text.empty() ? "" : " ") + std::to_string(row.internode);
    return text;
}

}  // namespace

TEST_CASE("segments are listed with ends, nodes, length and the group of most of their length")
{
    TraceList list;
    CHECK(list.update(tree(), TraceOrder::number, false));
    REQUIRE(list.segments().size() == 3);
    const SegmentRow& chain = list.segments()[0];
    CHECK(std::minmax(chain.first, chain.last) == std::minmax(0u, 2u));
    CHECK(chain.nodes == 3);
    CHECK(chain.length == 4.0);
    CHECK(chain.middle == glm::dvec3(2, 0, 0));
    CHECK_FALSE(chain.is_mixed);
    const SegmentRow& mixed = list.segments()[2];
    CHECK(mixed.is_mixed);
    CHECK(mixed.group == 3);
    CHECK(mixed.length == 7.0);
    REQUIRE(list.nodes().size() == 6);
    CHECK(list.nodes()[2].internodes == 3);
}

TEST_CASE("segments are sorted by what was asked for, equal ones by number")
{
    TraceList list;
    const TraceGraph trace = tree();
    list.update(trace, TraceOrder::length, true);
    CHECK(order_of(list) == "3 0 2");
    list.update(trace, TraceOrder::length, false);
    CHECK(order_of(list) == "2 0 3");
    list.update(trace, TraceOrder::nodes, false);
    CHECK(order_of(list) == "2 0 3");
    list.update(trace, TraceOrder::group, true);
    CHECK(order_of(list) == "3 2 0");
}

TEST_CASE("the lists are made anew only where the trace or the order is another")
{
    TraceList list;
    TraceGraph trace = tree();
    CHECK(list.update(trace, TraceOrder::length, true));
    CHECK_FALSE(list.update(trace, TraceOrder::length, true));
    CHECK(list.update(trace, TraceOrder::length, false));
    CHECK_FALSE(list.update(trace, TraceOrder::length, false));
    trace.apply(TraceNodeChange{9, {}, TraceNode{{9, 9, 9}, 1.0, 1}}, Direction::forwards);
    CHECK(list.update(trace, TraceOrder::length, false));
    CHECK(list.nodes().size() == 7);
    trace.apply(TraceNodeChange{9, {}, TraceNode{{9, 9, 9}, 1.0, 1}}, Direction::backwards);
    CHECK(list.update(trace, TraceOrder::length, false));
    CHECK(list.nodes().size() == 6);
}

TEST_CASE("a row selects its segment or node, and says where to look")
{
    TraceList list;
    const TraceGraph trace = tree();
    list.update(trace, TraceOrder::number, false);
    const Actions selects = select_segment(list.segments()[0]);
    REQUIRE(selects.size() == 2);
    const SelectOp op = *selects[0].as<SelectOp>();
    CHECK(op.is_internode);
    CHECK(op.number == 0u);
    CHECK(selects[1].is<SelectSegmentOp>());
    CHECK(go_to(list.segments()[0], {0.5, 1, 1}).as<GoTo>()->voxel == glm::dvec3(4, 0, 0));
    CHECK(select_node(list.nodes()[5])[0].as<SelectOp>()->number == 5u);
    CHECK(go_to(list.nodes()[5], trace, {1, 1, 2}).as<GoTo>()->voxel == glm::dvec3(5, 0, 3));
    CHECK(is_selected(list.segments()[0], {.nodes = {}, .internodes = {0, 1}}));
    CHECK_FALSE(is_selected(list.segments()[1], {.nodes = {2}, .internodes = {}}));
}

TEST_CASE("a hundred thousand nodes are listed, and a second look costs nothing")
{
    TraceGraph trace;
    constexpr uint32_t NODES = 100'000;
    for (uint32_t node = 0; node < NODES; ++node) {
        trace.apply(TraceNodeChange{node, {}, TraceNode{{double(node % 1000), double(node / 1000), 0}, 1.0, 1}},
                    Direction::forwards);
        if (node % 10 != 0)
            trace.apply(TraceInternodeChange{node, {}, TraceInternode{node - 1, node, 1}}, Direction::forwards);
    }
    TraceList list;
    CHECK(list.update(trace, TraceOrder::length, true));
    CHECK(list.segments().size() == NODES / 10);
    CHECK(list.nodes().size() == NODES);
    for (int again = 0; again < 1000; ++again) CHECK_FALSE(list.update(trace, TraceOrder::length, true));
}

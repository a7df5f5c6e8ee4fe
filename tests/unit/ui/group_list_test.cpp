// Groups as a tree: listed, found, rearranged; and the parts of a trace in them.

#include "engine/workbench/lists/group_list.h"

#include <doctest/doctest.h>

using namespace shvr;
using namespace shvr::ui;

namespace {

Groups family()
{
    Groups groups;
    groups[12].name = "Vascular bundles";
    groups[20] = {.name = "Leaf trace", .parent = 12};
    groups[21] = {.name = "Pith", .parent = 20};
    groups[3].name = "Cortex";
    return groups;
}

std::string text_of(const std::vector<GroupRow>& rows)
{
    std::string text;
    for (const GroupRow& row : rows)
        text += (text.empty() ? "" : " ") + std::string(size_t(row.depth), '>') + std::to_string(row.group) +
                (row.is_found ? "" : "?");
    return text;
}

const std::array<int64_t, 256> NOTHING{};

}  // namespace

TEST_CASE("listed are groups with a key, those described, painted, traced or chosen, each below its parent")
{
    CHECK(text_of(listed_groups({}, NOTHING, {}, 1)) == "0 1 2 3 4 5 6 7 8 9");
    std::array<int64_t, 256> painted{};
    painted[200] = 7;
    const std::vector<uint8_t> traced{33};
    CHECK(text_of(listed_groups(family(), painted, traced, 99)) == "0 1 2 3 4 5 6 7 8 9 12 >20 >>21 33 99 200");
}

TEST_CASE("a search finds parts of names whatever their case, and numbers; parents stay for the sake of what is found")
{
    CHECK(text_of(listed_groups(family(), NOTHING, {}, 1, "pith")) == "12? >20? >>21");
    CHECK(text_of(listed_groups(family(), NOTHING, {}, 1, "LEAF")) == "12? >20");
    CHECK(text_of(listed_groups(family(), NOTHING, {}, 1, "12")) == "12");
    CHECK(text_of(listed_groups(family(), NOTHING, {}, 1, "group 4")) == "4");
    CHECK(listed_groups(family(), NOTHING, {}, 1, "xylem").empty());
}

TEST_CASE("a group goes below any other but itself and those below it")
{
    const Groups groups = family();
    CHECK(why_not_below(groups, 3, 12) == "");
    CHECK(why_not_below(groups, 12, 21) == "group 21 is below group 12");
    CHECK(why_not_below(groups, 12, 12) == "a group cannot be below itself");
    CHECK(why_not_below(groups, 20, 12) == "it is there already");
    CHECK(why_not_below(groups, 20, 0) == "");
    CHECK(why_not_below(groups, 3, 0) == "it is below none");
    CHECK(why_not_below(groups, 0, 3) != "");
}

TEST_CASE("a new group is the first that nothing uses")
{
    std::array<int64_t, 256> painted{};
    painted[1] = 5;
    const std::vector<uint8_t> traced{2};
    CHECK(free_group(family(), painted, traced) == 4);
    painted.fill(1);
    CHECK(free_group({}, painted, {}) == 0);
}

TEST_CASE("what a trace has in a group is counted, with mean radii")
{
    TraceGraph trace;
    CHECK(trace.revision() == 0);
    for (uint32_t node = 0; node < 3; ++node)
        trace.apply(TraceNodeChange{node, {}, TraceNode{{double(node), 0, 0}, 1.0 + node, uint8_t(node < 2 ? 4 : 5)}},
                    Direction::forwards);
    trace.apply(TraceInternodeChange{0, {}, TraceInternode{0, 1, 4}}, Direction::forwards);
    trace.apply(TraceSizeChange{4, {}, 0.5}, Direction::forwards);
    const auto groups = traced_groups(trace);
    CHECK(groups[4].nodes == 2);
    CHECK(groups[4].node_radius == 1.5);
    CHECK(groups[4].internodes == 1);
    CHECK(groups[4].internode_radius == 0.5);
    CHECK_FALSE(groups[4].tapers);
    CHECK(groups[5].tapers);
    CHECK(groups_in(groups) == std::vector<uint8_t>{4, 5});
    const TraceGraph copy = trace;
    CHECK(copy.revision() == trace.revision());
    trace.apply(TraceSizeChange{4, 0.5, 0.75}, Direction::forwards);
    CHECK(copy.revision() != trace.revision());
}

TEST_CASE("a picture shows the groups that are painted or traced, and neither hidden nor clear")
{
    Session session;
    session.groups[2].visible = false;
    session.groups[3].parent = 2;
    session.groups[4].opacity = 0.0;
    session.groups[6].parent = 5;
    std::array<int64_t, 256> painted{};
    for (const size_t group : {1u, 2u, 3u, 4u, 5u, 6u}) painted[group] = 10;
    TraceGraph trace;
    trace.apply(TraceNodeChange{0, {}, TraceNode{{0, 0, 0}, 1.0, 9}}, Direction::forwards);
    using Drawn = std::vector<uint8_t>;
    CHECK(drawn_groups(session, painted, trace) == Drawn{1, 5, 6, 9});
    session.view.solo = 5;
    CHECK(drawn_groups(session, painted, trace) == Drawn{5, 6});
    session.view.solo = 0;
    CHECK(drawn_groups(session, painted, trace).empty());
    session.view.solo.reset();
    session.view.volume = false;  // the trace stays
    CHECK(drawn_groups(session, painted, trace) == Drawn{9});
    session.view.meshes = false;
    CHECK(drawn_groups(session, painted, trace).empty());
    painted[0] = 100;
    session.view.volume = true;
    CHECK(drawn_groups(session, painted, trace) == Drawn{1, 5, 6});
}

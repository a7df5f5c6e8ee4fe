// The tracer alone: steps through the nodes, drags, and the settings and moves that it asks others for.

#include <doctest/doctest.h>

#include "engine/workbench/services/tracer.h"
#include "tests/gpu/workbench/services/desk_with_scan.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

struct TracerAlone : DeskWithScan {
    std::optional<glm::dvec3> seen;
    std::optional<Camera> camera;
    std::string patch;
    glm::dvec3 moved_to{0.0};
    Tracer tracer{desk,
                  keeper,
                  {.pane = [this](size_t index) { return pane(index); },
                   .seen_at = [this](const Pane&, const glm::dvec2&) { return seen; },
                   .look_from = [this](const Camera& from) { camera = from; },
                   .move_probe =
                       [this](const glm::dvec3& point, bool) {
                           moved_to = point;
                           calls.emplace_back("move_probe");
                       },
                   .set = [this](const Set& change) { patch = change.patch; },
                   .record_settings = notes("record_settings"),
                   .show_changes = notes("show_changes")}};

    void add(double x) { tracer.act(NodeOp{.at = {x, 18, 16}, .radius_voxels = 1.0, .group = {}}); }
};

}  // namespace

TEST_CASE_FIXTURE(TracerAlone, "tracer: settings are recorded before a node, and a refused node changes nothing")
{
    add(8.0);
    CHECK(take_calls() == "record_settings show_changes");
    CHECK(trace().nodes().size() == 1);
    CHECK_FALSE(error_of([&] {
                    tracer.act(NodeOp{.at = {9, 9, 9}, .radius_voxels = {}, .group = uint8_t(0)});
                }).empty());
    CHECK(take_calls().empty());
    CHECK(trace().nodes().size() == 1);
}

TEST_CASE_FIXTURE(TracerAlone, "tracer: stepping from node to node looks at each, and takes the probe along")
{
    CHECK_FALSE(error_of([&] { tracer.act(StepNode{}); }).empty());
    for (const double x : {8.0, 16.0, 24.0}) add(x);
    tracer.act(StepNode{});  // from the last one to the first
    REQUIRE(camera);
    const glm::dvec3 first = trace().nodes().begin()->second.position;
    CHECK(camera->target == first);
    CHECK(moved_to == first);
    CHECK(trace().selection().node() == trace().nodes().begin()->first);
    tracer.act(StepNode{.back = true});
    CHECK(moved_to == std::prev(trace().nodes().end())->second.position);
}

// Kind (Touch): stepping through nodes of hidden groups
TEST_CASE_FIXTURE(TracerAlone, "tracer: stepping passes over nodes of hidden groups, unless hidden parts are felt")
{
    for (const uint8_t group : {uint8_t(1), uint8_t(2), uint8_t(2), uint8_t(3)})
        tracer.act(NodeOp{.at = {8.0 + 4.0 * double(group), 18, 16}, .radius_voxels = 1.0, .group = group});
    const auto group_after = [&](bool back) {
        tracer.act(StepNode{back});
        return int(trace().node(trace().selection().node().value()).group);
    };
    document().session.groups[2].visible = false;
    for (const int group : {1, 3, 1}) CHECK(group_after(false) == group);
    for (const int group : {3, 1, 3}) CHECK(group_after(true) == group);
    document().session.groups[3].visible = false;
    CHECK(group_after(false) == 1);
    CHECK(group_after(true) == 1);
    document().session.groups[1].visible = false;
    moved_to = {};
    CHECK(contains(error_of([&] { tracer.act(StepNode{}); }), "all nodes of the trace are in hidden groups"));
    CHECK(moved_to == glm::dvec3(0.0));
    document().session.probe.touch.feels_hidden = true;
    CHECK(group_after(false) == 2);
}

TEST_CASE_FIXTURE(TracerAlone, "tracer: a dragged node moves to the probe when it is let go")
{
    CHECK(contains(error_of([&] { tracer.act(DragNode{true}); }), "is selected; select a node"));
    add(8.0);
    tracer.act(DragNode{true});
    CHECK(tracer.model().drags_node);
    document().touch.place(glm::dvec3(11.0, 18.0, 16.0) * document().volume().spacing);
    tracer.act(DragNode{false});
    CHECK_FALSE(tracer.model().drags_node);
    CHECK(glm::distance(trace().nodes().begin()->second.position,
                        glm::dvec3(11.0, 18.0, 16.0) * document().volume().spacing) < 1e-9);
}

TEST_CASE_FIXTURE(TracerAlone, "tracer: a click on paint asks for its group, one on nothing deselects")
{
    seen = paint();
    tracer.act(SelectAt{.pane = 0, .pixel = {1.0, 1.0}});
    CHECK(patch.empty());
    CHECK(says("is the active group already"));
    document().session.probe.brush.group = 2;
    tracer.act(SelectAt{.pane = 0, .pixel = {1.0, 1.0}});
    CHECK(contains(patch, "group"));

    document().session.probe.brush.group = 1;
    add(8.0);
    seen.reset();
    CHECK(trace().selection().node());
    tracer.act(SelectAt{.pane = 0, .pixel = {1.0, 1.0}});
    CHECK_FALSE(trace().selection().node());
    CHECK(contains(error_of([&] { tracer.act(NodeAt{.pane = 0, .pixel = {1.0, 1.0}}); }), "Nothing is seen there"));
}

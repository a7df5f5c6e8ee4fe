// Effects of the mouse in each tool, without a display.

#include "ui/viewport.h"
#include "ui/mouse_feed.h"

#include <doctest/doctest.h>

#include <cmath>

#include "engine/session/session_patch.h"
#include "engine/workbench/actions/action_rows.h"
#include "tests/support/model_world.h"
#include "ui/panels/tools/outline_tool.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

constexpr int LEFT = 0, RIGHT = 1, MIDDLE = 2, SHIFT = 1, CONTROL = 2, ALT = 4;

/// A mouse over a picture of 400 x 300 pixels, whose first pane has a node in its middle.
struct Mouse {
    World world;
    Viewport viewport;
    double now_s = 100.0;
    std::string said;  ///< ids of the actions so far

    explicit Mouse(Tool tool, bool has_slice = false)
    {
        world.session.probe.tool = tool;
        world.volume.size = {100, 100, 100};
        world.statistics.maximum = 1000.0;
        Camera camera;
        camera.projection = Camera::Projection::orthographic;
        camera.eye = {50.0, 50.0, 200.0};
        camera.target = {50.0, 50.0, 50.0};
        camera.up = {0.0, 1.0, 0.0};
        camera.height = 300.0;
        const glm::uvec2 end(has_slice ? 200 : 400, 300);
        add({.kind = Pane::Kind::main, .shot = camera, .box = {{0, 0}, end}, .name = "camera"});
        if (has_slice) {
            Pane slice{.kind = Pane::Kind::slice, .shot = camera, .box = {{200, 0}, {400, 300}}, .name = "z"};
            slice.shot.is_slice = true;
            slice.axis = 2;
            add(slice);
        }
        world.trace.apply(TraceNodeChange{0, {}, TraceNode{{50.0, 50.0, 50.0}, 2.0, 1}}, Direction::forwards);
        viewport.set_layout({.begin = {0, 0}, .end = {400, 300}});
    }
    void add(const Pane& pane) { world.panes.push_back({.pane = pane, .view = nullptr}); }

    Actions last;
    void handle(const InputEvent& event, bool ui_has_mouse = false)
    {
        last.clear();
        viewport.handle(event, world.model, ui_has_mouse, last);
        note();
    }
    void note()
    {
        for (const Action& action : last) said += (said.empty() ? "" : " ") + std::string(row_of(action).id);
    }
    void move(double x, double y, bool ui_has_mouse = false, int mods = 0)
    {
        handle({MoveEvent{{x, y}, mods}, now_s}, ui_has_mouse);
    }
    void press(int button, double x, double y, int mods = 0)
    {
        handle({ButtonEvent{button, mods, true, {x, y}}, now_s});
    }
    void release(int button, double x, double y) { handle({ButtonEvent{button, 0, false, {x, y}}, now_s}); }
    void click(double x, double y)
    {
        press(LEFT, x, y);
        release(LEFT, x, y);
    }
    /// A press, some motion, and a release; returns the requested actions.
    std::string drag(int button, double x, double y, int mods = 0)
    {
        said.clear();
        press(button, x, y, mods);
        move(x + 3.0, y);
        move(x + 12.0, y);
        release(button, x + 12.0, y);
        return said;
    }
    std::string wait(double seconds)
    {
        said.clear();
        last.clear();
        viewport.wait(now_s += seconds, last);
        note();
        return said;
    }
};

}  // namespace

TEST_CASE("Each button means in each tool what the tool says")
{
    const auto drag = [](Tool tool, int button, int mods = 0) { return Mouse(tool).drag(button, 40.0, 40.0, mods); };
    for (const Tool tool : {Tool::turn, Tool::trace, Tool::select}) {
        CAPTURE(TOOLS[size_t(tool)].name);
        CHECK(drag(tool, LEFT) == "orbit");
    }
    for (const Tool tool : {Tool::paint, Tool::erase})
        CHECK(drag(tool, LEFT) == "probe_along paint_here probe_along probe_along paint_here");
    CHECK(drag(Tool::measure, LEFT) == "measure_at measure_at");  // from the press to the release
    CHECK(drag(Tool::turn, RIGHT) == "zoom zoom");
    Mouse as_in_the_thesis(Tool::turn);
    as_in_the_thesis.world.preferences.key_set = KeySet::thesis;
    CHECK(as_in_the_thesis.drag(RIGHT, 40.0, 40.0) == "probe_to paint_here probe_to probe_to paint_here");
    for (const Tool tool : {Tool::paint, Tool::erase, Tool::trace, Tool::select, Tool::measure}) {
        CAPTURE(TOOLS[size_t(tool)].name);
        CHECK(drag(tool, RIGHT) == "orbit orbit");
        CHECK(drag(tool, MIDDLE) == "orbit orbit");
        CHECK(drag(tool, MIDDLE, SHIFT) == "move_view move_view");
    }
    CHECK(drag(Tool::turn, MIDDLE) == "move_view move_view");
    for (const Spelling<Tool>& tool : TOOLS) {
        CAPTURE(tool.name);
        CHECK(drag(tool.value, LEFT, SHIFT) == "move_view move_view");
        CHECK(drag(tool.value, LEFT, ALT) == "orbit orbit");
    }
}

TEST_CASE(
    "A double click is told by when its presses can have happened, not by when a long frame lets them be received")
{
    const auto clicked = [](double earliest_s, double latest_s) {
        Mouse mouse(Tool::turn);
        mouse.press(LEFT, 40.0, 40.0);
        mouse.now_s += 0.4;  // held for long: the time runs from press to press
        mouse.release(LEFT, 40.0, 40.0);
        mouse.handle({ButtonEvent{LEFT, 0, true, {40.0, 40.0}}, 100.0 + latest_s, 100.0 + earliest_s});
        mouse.release(LEFT, 40.0, 40.0);
        return mouse.said;
    };
    CHECK(clicked(0.45, 0.45) == "probe_onto");
    CHECK(clicked(0.45, 3.0) == "probe_onto");
    CHECK(clicked(MouseFeed::DOUBLE_CLICK_S + 0.01, 3.0) == "");
    // A third click is the first of the next two.
    Mouse mouse(Tool::turn);
    for (int i = 0; i < 3; ++i) mouse.click(40.0, 40.0);
    CHECK(mouse.said == "probe_onto");
    CHECK(mouse.viewport.is_waiting());
}

TEST_CASE("A click of the turn tool selects once it is no double click, which puts the probe there")
{
    Mouse mouse(Tool::turn);
    mouse.click(40.0, 40.0);
    CHECK(mouse.said == "");
    CHECK(mouse.viewport.is_waiting());
    CHECK(mouse.wait(MouseFeed::DOUBLE_CLICK_S - 0.01) == "");
    CHECK(mouse.wait(0.02) == "select_at");
    CHECK(!mouse.viewport.is_waiting());
    mouse.said.clear();
    mouse.click(40.0, 40.0);
    mouse.now_s += 0.1;
    mouse.click(41.0, 40.0);
    CHECK(mouse.said == "probe_onto");
    CHECK(mouse.wait(1.0) == "");
    // Two clicks at two places are two clicks.
    mouse.said.clear();
    mouse.click(40.0, 40.0);
    mouse.now_s += 0.1;
    mouse.click(140.0, 40.0);
    CHECK(mouse.said == "");
}

TEST_CASE("Slices follow a click of the turn tool in the volume at once, but not with the keys of the thesis")
{
    Mouse mouse(Tool::turn, true);
    mouse.click(40.0, 40.0);
    CHECK(mouse.said == "probe_onto");
    CHECK(mouse.wait(1.0) == "select_at");
    Mouse thesis(Tool::turn, true);
    thesis.world.preferences.key_set = KeySet::thesis;
    thesis.click(40.0, 40.0);
    CHECK(thesis.said == "");
}

TEST_CASE("Clicks trace, select and measure; a press that moves is none")
{
    Mouse trace(Tool::trace);
    trace.click(40.0, 40.0);
    CHECK(trace.said == "node_at");
    trace.said.clear();
    trace.click(200.0, 152.0);  // on the node
    CHECK(trace.said == "select");
    CHECK(trace.last[0].as<SelectOp>()->number == 0u);
    CHECK(trace.drag(LEFT, 200.0, 152.0) == "select place_probe drag_node probe_to drag_node");
    // A node of a selected segment takes the segment along.
    TraceGraph& graph = trace.world.trace;
    graph.apply(TraceNodeChange{1, {}, TraceNode{{80.0, 50.0, 50.0}, 2.0, 1}}, Direction::forwards);
    graph.apply(TraceInternodeChange{0, {}, TraceInternode{0, 1}}, Direction::forwards);
    graph.select({{0, 1}, {0}});
    trace.said.clear();
    CHECK(trace.drag(LEFT, 200.0, 152.0) == "place_probe drag_node probe_to drag_node");

    Mouse select(Tool::select);
    select.click(40.0, 40.0);
    CHECK(select.said == "select_at");
    CHECK(!select.last[0].as<SelectAt>()->whole_segment);
    select.now_s += 0.1;
    select.click(40.0, 40.0);
    CHECK(select.last[0].as<SelectAt>()->whole_segment);

    Mouse measure(Tool::measure);
    measure.click(40.0, 40.0);
    measure.click(80.0, 40.0);
    CHECK(measure.said == "measure_at measure_at");
}

TEST_CASE("The probe follows what is seen in tools that work there, and its plane in the others")
{
    for (const Spelling<Tool>& tool : TOOLS) {
        CAPTURE(tool.name);
        Mouse mouse(tool.value);
        mouse.move(40.0, 40.0);
        const bool lands = tool.value != Tool::turn && tool.value != Tool::select;
        CHECK(mouse.said == std::string(lands ? "probe_along" : "probe_to"));
        CHECK((mouse.viewport.pointer() == Pointer{0, {40.0, 40.0}}));
    }
}

TEST_CASE("A motion that no hand makes lifts the brush, and so does the first after the pointer was elsewhere")
{
    Mouse mouse(Tool::turn);
    const auto jumps = [&] { return mouse.last.at(0).as<ProbeTo>()->jumps; };
    mouse.move(40.0, 40.0);
    CHECK(jumps());  // its last position is unknown
    mouse.move(60.0, 40.0);
    CHECK(!jumps());
    mouse.move(200.0, 40.0);
    CHECK(jumps());  // more than a quarter of 300 pixels
    mouse.move(210.0, 40.0, true);
    CHECK(mouse.last.empty());
    CHECK(!mouse.viewport.pointer().has_value());
    mouse.move(215.0, 40.0);
    CHECK(jumps());
    mouse.move(220.0, 40.0);
    CHECK(!jumps());
    // A stroke goes on from where its button went down.
    mouse.world.preferences.key_set = KeySet::thesis;
    mouse.press(RIGHT, 390.0, 200.0);
    CHECK(jumps());
    mouse.move(380.0, 200.0);
    CHECK(!jumps());
    mouse.move(20.0, 20.0);
    CHECK(jumps());
}

TEST_CASE("An upward drag with the right button comes nearer, and Shift + wheel changes the brush in every pane")
{
    Mouse mouse(Tool::turn, true);
    mouse.press(RIGHT, 40.0, 100.0);
    mouse.move(40.0, 70.0);
    REQUIRE(mouse.last.size() == 1);
    CHECK(mouse.last[0].as<Zoom>()->factor == doctest::Approx(std::pow(8.0, 0.1)));
    CHECK(mouse.last[0].as<Zoom>()->pixel == glm::dvec2(40.0, 100.0));
    mouse.release(RIGHT, 40.0, 70.0);
    for (const double x : {40.0, 300.0}) {
        mouse.said.clear();
        mouse.handle({ScrollEvent{2.0, SHIFT, {x, 40.0}}, mouse.now_s});
        CHECK(mouse.said == "scale_probe");
        CHECK(mouse.last[0].as<ScaleProbe>()->factor == doctest::Approx(1.21));
    }
}

TEST_CASE("In a slice the cross is dragged, and the contrast with Ctrl or the right button")
{
    CHECK(Mouse(Tool::select, true).drag(LEFT, 300.0, 40.0) == "probe_to");
    CHECK(Mouse(Tool::measure, true).drag(LEFT, 300.0, 40.0) == "measure_at measure_at");
    CHECK(Mouse(Tool::turn, true).drag(LEFT, 300.0, 40.0) == "probe_to probe_to probe_to");
    for (const Tool tool : {Tool::paint, Tool::trace, Tool::select, Tool::measure})
        CHECK(Mouse(tool, true).drag(RIGHT, 300.0, 40.0) == "set set");
    CHECK(Mouse(Tool::turn, true).drag(RIGHT, 300.0, 40.0) == "zoom zoom");
    CHECK(Mouse(Tool::paint, true).drag(LEFT, 300.0, 40.0) ==
          "probe_along paint_here probe_along probe_along paint_here");
    Mouse mouse(Tool::paint, true);
    CHECK(mouse.drag(LEFT, 300.0, 40.0, CONTROL) == "set set");
    mouse.press(LEFT, 300.0, 40.0, CONTROL);
    mouse.move(300.0, 190.0);  // half a height down: darker by half the window
    const Session after = patched(mouse.world.session, mouse.last.at(0).as<Set>()->patch);
    CHECK(*after.view.slices.black == doctest::Approx(500.0));
    CHECK(*after.view.slices.white == doctest::Approx(1500.0));
    // A click of the turn tool is enough, except with the keys of the thesis.
    for (const KeySet set : {KeySet::modern, KeySet::thesis}) {
        Mouse clicking(Tool::turn, true);
        clicking.world.preferences.key_set = set;
        clicking.click(300.0, 40.0);
        CHECK(clicking.said == (set == KeySet::thesis ? "" : "probe_to"));
    }
    // Tools that point leave the probe where it is.
    Mouse pointing(Tool::measure, true);
    pointing.move(300.0, 40.0);
    CHECK(pointing.said == "");
    CHECK((pointing.viewport.pointer() == Pointer{1, {100.0, 40.0}}));
}

TEST_CASE("While a cut is chosen, a drag draws its outline, with Ctrl a rectangle, and Enter and Escape end it")
{
    using Wish = OutlineTool::Wish;
    OutlineTool& tool = outline_tool();
    for (const bool is_slice : {false, true})
        for (const Tool held : {Tool::turn, Tool::paint, Tool::trace, Tool::measure}) {
            CAPTURE(is_slice);
            Mouse mouse(held, is_slice);
            const double left = is_slice ? 200.0 : 0.0;
            CHECK(mouse.drag(LEFT, left + 40.0, 40.0) != "");  // not on
            tool.set_on(true);
            CHECK(!tool.wants(Wish::apply));  // keys are the scene's until something is drawn
            CHECK(!tool.wants(Wish::cancel));
            CHECK(mouse.drag(LEFT, left + 40.0, 40.0, CONTROL) == "");
            CHECK((tool.drawn()->outline == std::vector<glm::dvec2>{{40, 40}, {52, 40}, {52, 40}, {40, 40}}));
            mouse.press(LEFT, left + 40.0, 40.0);
            mouse.move(left + 41.0, 40.0);  // less than a step
            mouse.move(left + 80.0, 50.0);
            CHECK(tool.is_drawing());
            CHECK(!tool.wants(Wish::apply));
            LassoOp op{.polygon = {{1, 1}, {2, 2}, {2, 1}}};
            tool.set(op, std::nullopt, mouse.world.model);
            CHECK(op.polygon.empty());
            mouse.move(left + 60.0, 90.0);
            mouse.release(LEFT, left + 60.0, 90.0);
            CHECK((tool.drawn()->outline == std::vector<glm::dvec2>{{40, 40}, {80, 50}, {60, 90}}));
            CHECK((tool.drawn()->origin == glm::dvec2(left, 0)));
            tool.set(op, std::nullopt, mouse.world.model);
            CHECK(op.polygon.size() == 3);
            CHECK(tool.wants(Wish::apply));
            CHECK((tool.take_wish() == Wish::apply && tool.take_wish() == Wish::none));
            mouse.click(left + 40.0, 40.0);  // too small: nothing is drawn any more
            CHECK(!tool.drawn());
            CHECK(mouse.drag(LEFT, left + 40.0, 40.0, SHIFT) != "");  // moves
            tool.set_on(false);
        }
}

TEST_CASE("Slices follow a pointer without a button only while Shift is held")
{
    const auto hovers = [](const Action& action) {
        const auto* to = action.as<ProbeTo>();
        return to ? to->hovers : action.as<ProbeAlong>()->hovers;
    };
    for (const Spelling<Tool>& tool : TOOLS)
        for (const double x : {40.0, 300.0}) {
            CAPTURE(tool.name);
            CAPTURE(x);
            Mouse mouse(tool.value, true);
            mouse.move(x, 40.0);
            for (const Action& action : mouse.last) CHECK(hovers(action));
            mouse.move(x + 1.0, 40.0, false, SHIFT);
            REQUIRE(mouse.last.size() == 1);
            REQUIRE(mouse.last[0].as<ProbeAlong>());  // onto what is seen, with every tool
            CHECK(!hovers(mouse.last[0]));
        }
    Mouse pressing(Tool::turn, true);
    pressing.press(LEFT, 300.0, 40.0);
    CHECK(!hovers(pressing.last.at(0)));
}

TEST_CASE("Handles of the clip box are dragged in the volume and in a slice, with each tool, while the box is shown")
{
    for (const Spelling<Tool>& tool : TOOLS)
        for (const double left : {0.0, 200.0}) {
            CAPTURE(tool.name);
            CAPTURE(left);
            Mouse mouse(tool.value, true);
            Session& session = mouse.world.session;
            session.cut = {{0.0, 0.0, 0.0}, {100.0, 80.0, 100.0}};
            // The far face along x: at 50 pixels to the right of the middle, half-way up what is left along y.
            const glm::dvec2 handle(left + 150.0, 160.0);
            CHECK(mouse.drag(LEFT, handle.x, handle.y) != "set set");
            session.view.cut_box = true;
            CHECK(mouse.drag(LEFT, handle.x, handle.y, SHIFT) != "set set");
            mouse.press(LEFT, handle.x + 2.0, handle.y);
            CHECK(mouse.last.empty());
            mouse.move(handle.x - 28.0, handle.y + 70.0);
            REQUIRE(mouse.last.size() == 1);
            const Session after = patched(session, mouse.last[0].as<Set>()->patch);
            CHECK(after.cut.upper.x == doctest::Approx(70.0));
            CHECK(after.cut.upper.y == 80.0);
            mouse.move(handle.x - 500.0, handle.y);  // not beyond the other face
            CHECK(patched(session, mouse.last.at(0).as<Set>()->patch).cut.upper.x == 1.0);
            mouse.release(LEFT, handle.x - 500.0, handle.y);
            CHECK(mouse.last.empty());
        }
}

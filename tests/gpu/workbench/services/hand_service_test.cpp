// The hand alone: a device's buttons and grip, recordings, and following them, without strokes, probe or trace.

#include <doctest/doctest.h>

#include "engine/base/latest.h"
#include "engine/workbench/services/hand.h"
#include "tests/gpu/workbench/services/desk_with_scan.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

/// A device whose state the test sets.
class HeldDevice : public HapticDevice {
public:
    Latest<DeviceState> held;
    DeviceCaps caps() const noexcept override { return {}; }
    ReadResult read(DeviceState& state) noexcept override
    {
        held.take();
        state = held.value();
        state.time_ns = ++reads_ * 1'000'000;
        state.sequence = uint32_t(reads_);
        return ReadResult::fresh;
    }
    bool write(const glm::dvec3&, uint32_t) noexcept override { return true; }

private:
    uint64_t reads_ = 0;
};

struct HandAlone : DeskWithScan {
    std::optional<Camera> camera;
    std::vector<PaintOp> strokes;
    size_t nodes = 0;
    std::shared_ptr<HeldDevice> device = std::make_shared<HeldDevice>();
    Hand hand{desk,
              keeper,
              {.look_from = [this](const Camera& from) { camera = from; },
               .move_probe = notes("move_probe"),
               .paint = [this](const PaintOp& stroke) { strokes.push_back(stroke); },
               .trace = [this](const TraceOp&) { ++nodes; },
               .stem = [this] { return folder.path / "here"; }}};

    void hold(const glm::dvec3& position_m, uint32_t buttons)
    {
        DeviceState state;
        state.position_m = position_m;
        state.buttons = buttons;
        device->held.publish(state);
    }
    template <class Condition>
    void turn_until(const Condition& condition)
    {
        until([this] { hand.advance(); }, condition);
    }
    /// The first button is down from the tick on at which a stylus has settled.
    std::filesystem::path write_path_along_x()
    {
        constexpr double VOXEL_M = 0.00025;
        Trace trace;
        trace.unit = "voxel";
        TraceSettings settings;
        settings.force.workspace = {glm::dmat3(1.0 / VOXEL_M), {12.0, 18.0, 16.0}};
        trace.settings.push_back(settings);
        for (size_t i = 0; i < 400; ++i) {
            TraceTick tick;
            tick.now_ns = 1'000'000 * (i + 1);
            tick.state.time_ns = tick.now_ns;
            tick.state.sequence = uint32_t(i + 1);
            tick.state.position_m = {16.0 * VOXEL_M * double(i) / 400.0, 0.0, 0.0};
            tick.state.buttons = i >= 200 ? PAINT_BUTTON : 0;
            trace.ticks.push_back(tick);
        }
        write_trace(folder.path / "way.trace", trace);
        return folder.path / "way.trace";
    }
};

}  // namespace

TEST_CASE_FIXTURE(HandAlone, "hand: a device moves the probe, its button acts like the key, and its grip the view")
{
    CHECK(contains(error_of([&] { hand.act(GrabVolume{true}); }), "no stylus moves the probe"));
    hand.use_device(device, "a pen");
    turn_until([&] { return document().touch.servo() && document().touch.servo()->ticks > 0; });
    CHECK(hand.model().hand->moves_probe);
    CHECK(applied.empty());
    hold({}, PAINT_BUTTON);
    turn_until([&] { return !applied.empty(); });
    CHECK(contains(applied[0], "\"paint_here\""));
    hold({}, 0);
    turn_until([&] { return applied.size() > 1; });
    hand.act(GrabVolume{true});
    hold({0.01, 0.0, 0.0}, 0);
    turn_until([&] { return camera && camera->eye != document().camera.eye; });
    hand.act(LetGo{true});
    CHECK(hand.model().hand->is_let_go);
    hand.advance();
    CHECK_FALSE(hand.model().hand->is_grabbing);
}

TEST_CASE_FIXTURE(HandAlone, "hand: a recording has a free name next to the session, and is written by a saver")
{
    CHECK(contains(error_of([&] { hand.act(RecordStylus{}); }), "no device runs here"));
    desk.options.has_servo = true;
    hand.use_device(device, "a pen");
    std::ofstream(folder.path / "here-stylus-1.trace") << "another";
    turn_until([&] { return document().touch.servo() != nullptr; });
    hand.act(RecordStylus{});
    CHECK(hand.model().hand->recording == folder.path / "here-stylus-2.trace");
    turn_until([&] { return document().touch.recorder()->seconds() > 0.0; });
    hand.act(StopRecording{});
    until([&] { static_cast<void>(desk.savers.finish()); }, [&] { return desk.savers.is_idle(); });
    CHECK(says("Recorded"));
    CHECK(read_trace(folder.path / "here-stylus-2.trace").ticks.size() > 0);
    CHECK(bytes_of_file(folder.path / "here-stylus-1.trace") == "another");
}

TEST_CASE_FIXTURE(HandAlone, "hand: following a recording paints while the button is down, or adds nodes")
{
    const std::filesystem::path path = write_path_along_x();
    const auto follow = [&] {
        hand.act(FollowStylus{.path = path, .by_hand = false, .node_every_voxels = 2.0});
        until([&] { CHECK(desk.jobs.finish().size() < 2); }, [&] { return desk.jobs.is_idle(); });
    };
    follow();
    REQUIRE(strokes.size() == 1);
    CHECK(strokes[0].path.size() > 5);
    CHECK(strokes[0].path.front().x > 19.0);
    CHECK(nodes == 0);
    CHECK(take_calls() == "move_probe");
    document().session.probe.tool = Tool::trace;
    follow();
    CHECK(strokes.size() == 1);
    CHECK(nodes > 2);
    ++desk.openings;  // another document is open when the job ends
    const size_t before = nodes;
    hand.act(FollowStylus{.path = path, .by_hand = false, .node_every_voxels = 2.0});
    ++desk.openings;
    until([&] { CHECK(desk.jobs.finish().size() < 2); }, [&] { return desk.jobs.is_idle(); });
    CHECK(nodes == before);
}

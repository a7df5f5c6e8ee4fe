// The hand at the workbench, with simulated devices: which is used, ways of touching, where tools act, the volume and
// the view in the hand, and recordings.

#include <chrono>
#include <mutex>
#include <thread>

#include <doctest/doctest.h>

#include "engine/base/file.h"
#include "engine/workbench/bindings/preferences_file.h"
#include "haptics/replay/replay.h"
#include "haptics/simulated_device.h"
#include "tests/support/gpu.h"
#include "tests/support/volume_files.h"
#include "tests/support/workbench_state.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

template <class Condition>
bool turn_until(Workbench& bench, const Condition& condition, int turns = 5000)
{
    for (int turn = 0; turn < turns; ++turn) {
        bench.advance();
        if (condition()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
}

/// The devices that are plugged in, which a test changes.
struct Plugs {
    std::mutex mutex;
    std::vector<DeviceListing> rows;
    std::string refuses;  ///< id of one that cannot be opened
    int opened = 0;

    DeviceSource source()
    {
        return {.list =
                    [this] {
                        const std::lock_guard lock(mutex);
                        return rows;
                    },
                .open = [this](const std::string& id) -> std::unique_ptr<HapticDevice> {
                    const std::lock_guard lock(mutex);
                    if (id == refuses) fail("A pen: its driver says no");
                    ++opened;
                    return std::make_unique<SimulatedDevice>(MODELLED_HAND);
                }};
    }
    void plug(std::vector<DeviceListing> now)
    {
        const std::lock_guard lock(mutex);
        rows = std::move(now);
        DeviceListing mouse;
        mouse.id = "mouse";
        mouse.name = "Mouse";
        rows.push_back(mouse);
    }
};

DeviceListing listed(const char* id, const char* name, const char* serial)
{
    DeviceListing row;
    row.kind = DeviceKind::hid;
    row.id = id;
    row.name = name;
    row.serial = serial;
    row.has_force = true;
    return row;
}

/// A device that states speeds.
class Puck : public HapticDevice {
public:
    explicit Puck(Latest<DeviceState>& at) : at_(at) {}
    DeviceCaps caps() const noexcept override { return {.rate_control = true}; }
    ReadResult read(DeviceState& state) noexcept override
    {
        at_.take();
        state = at_.value();
        state.time_ns = ++reads_ * 1'000'000;
        state.sequence = uint32_t(reads_);
        return ReadResult::fresh;
    }
    bool write(const glm::dvec3&, uint32_t) noexcept override { return true; }

private:
    Latest<DeviceState>& at_;
    uint64_t reads_ = 0;
};

Action of(const char* id, const Workbench& bench, double amount = 1.0)
{
    return shortcut_named(id)->action(bench.model(), amount);
}

/// A straight stylus path through the tubes scan along x, in that scan's units, the button down.
Trace path_along_x(const glm::dvec3& from, double length, size_t ticks)
{
    constexpr double VOXEL_M = 0.00025;
    Trace trace;
    trace.unit = "voxel";
    trace.caps.outputs_force = true;
    TraceSettings settings;
    settings.force.workspace = {glm::dmat3(1.0 / VOXEL_M), from};
    trace.settings.push_back(settings);
    for (size_t i = 0; i < ticks; ++i) {
        TraceTick tick;
        tick.now_ns = 1'000'000 * (i + 1);
        tick.state.time_ns = tick.now_ns;
        tick.state.sequence = uint32_t(i + 1);
        tick.state.position_m = {length * VOXEL_M * double(i) / double(ticks), 0.0, 0.0};
        tick.state.buttons = i > 1200 ? PAINT_BUTTON : 0;
        trace.ticks.push_back(tick);
    }
    return trace;
}

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "a device is found when it is plugged in, is called by its name, and is left when it goes")
{
    TemporaryFolder folder;
    Plugs plugs;
    plugs.plug({});
    double now_s = 1.0;
    Workbench bench(renderer(),
                    {.settings = folder.path, .now_s = [&] { return now_s += 0.01; }, .devices = plugs.source()});
    bench.open(write_tubes_session(folder.path), {});
    const HandView& hand = *bench.model().hand;
    REQUIRE(turn_until(bench, [&] { return hand.has_looked; }));
    CHECK(hand.devices.size() == 1);
    CHECK(!hand.moves_probe);

    plugs.plug({listed("hid:a", "A pen", "17"), listed("hid:b", "Another pen", "18")});
    REQUIRE(turn_until(bench, [&] { return hand.moves_probe; }));
    CHECK(hand.name == "A pen");
    CHECK(hand.serial == "17");
    CHECK(bench.messages().last() == "A pen (serial 17) moves the probe");

    // The chosen device is remembered by name and serial number.
    CHECK(bench.why_not(UseDevice{"hid:c"}) == "no device hid:c is plugged in");
    bench.perform(UseDevice{"hid:b"});
    REQUIRE(turn_until(bench, [&] { return hand.in_use == "hid:b" && hand.moves_probe; }));
    CHECK(bench.model().preferences.device == ChosenDevice{"Another pen", "18"});
    const auto kept = [&] { return load_preferences(folder.path / "preferences.json").device; };
    REQUIRE(turn_until(bench, [&] { return kept() == ChosenDevice{"Another pen", "18"}; }));

    plugs.plug({listed("hid:a", "A pen", "17")});
    REQUIRE(turn_until(bench, [&] { return !hand.moves_probe; }));
    CHECK(bench.messages().last() == "Another pen (serial 18) is gone; the mouse moves the probe");
    bench.perform(PlaceProbe{{11.0, 12.0, 13.0}});
    bench.advance();
    CHECK(bench.model().probe_voxel == glm::dvec3(11.0, 12.0, 13.0));
    // It may return at another port.
    plugs.plug({listed("hid:a", "A pen", "17"), listed("hid:z", "Another pen", "18")});
    REQUIRE(turn_until(bench, [&] { return hand.in_use == "hid:z" && hand.moves_probe; }));

    const int opened = plugs.opened;
    bench.perform(CalibrateDevice{});
    REQUIRE(turn_until(bench, [&] { return hand.in_use == "hid:z" && hand.moves_probe; }));
    CHECK(plugs.opened == opened + 1);

    // One that cannot be opened says why, once.
    plugs.refuses = "hid:a";
    bench.perform(UseDevice{"hid:a"});
    REQUIRE(turn_until(bench, [&] { return !hand.trouble.empty(); }));
    CHECK(hand.trouble == "A pen: its driver says no");
    const uint64_t said = bench.messages().count();
    turn_until(
        bench, [] { return false; }, 600);
    CHECK(bench.messages().count() == said);
    bench.perform(UseDevice{"mouse"});
    turn_until(
        bench, [] { return false; }, 300);
    CHECK(!hand.moves_probe);
    CHECK(bench.model().preferences.device.name == "Mouse");
}

TEST_CASE_FIXTURE(OnDevice, "ways of touching are settings: by key in both sets, in words, and kept")
{
    TemporaryFolder folder;
    Workbench bench(renderer(), {.has_servo = false});
    bench.open(write_tubes_session(folder.path), {});
    const FeelSettings& touch = bench.document().session.probe.touch;
    bench.perform(of("next_mode", bench));
    CHECK(touch.mode == TouchMode::surface);
    CHECK(bench.messages().last() == "Touching: held on surfaces, until you pull towards yourself");
    bench.perform(of("next_mode", bench));
    CHECK(touch.mode == TouchMode::object);
    bench.perform(of("weaker", bench, 4.0));
    CHECK(touch.strength == doctest::Approx(0.8));
    CHECK(bench.messages().last() == "Strength 80 %");
    bench.perform(of("weaker", bench, 400.0));
    CHECK(touch.strength == 0.0);
    bench.perform(Set{R"({"probe":{"guidance":"thesis","touch":{"groups":[5,0,5],"plane":"y"}}})"});
    CHECK(touch.groups == std::vector<uint8_t>{0, 5});
    const FeelSettings left = touch;
    bench.perform(SaveOp{});
    settle(bench);
    Workbench again(renderer(), {.has_servo = false});
    again.open(folder.path / "scan.json", {});
    CHECK(again.document().session.probe.touch == left);
    CHECK(again.document().session.probe.guidance == ProxyLaw::thesis);
    CHECK_THROWS_AS(bench.perform(Set{R"({"probe":{"touch":{"groups":[256]}}})"}), Error);
    CHECK_THROWS_AS(bench.perform(Set{R"({"probe":{"touch":{"strength":1.5}}})"}), Error);
    CHECK(Keymap(KeySet::thesis).text_of(*shortcut_named("next_mode")) == "Home");
    CHECK(Keymap(KeySet::modern).text_of(*shortcut_named("let_go")) == "Pause");
}

TEST_CASE_FIXTURE(OnDevice, "guidance by the mouse feels, lets go, and feels no group that is not felt")
{
    TemporaryFolder folder;
    Workbench bench(renderer(), {});
    bench.open(write_tubes_session(folder.path), {});
    bench.perform(Set{R"({"probe":{"guided":true}})"});
    const auto step = [&]() -> const ForceStep& { return bench.document().touch.last_state().step; };
    REQUIRE(turn_until(bench, [&] { return step().in_contact && glm::length(step().force_n) > 0.01; }));
    bench.perform(LetGo{true});
    REQUIRE(turn_until(bench, [&] { return (step().flags & FORCE_LET_GO) != 0; }));
    CHECK(step().force_n == glm::dvec3(0.0));
    CHECK(bench.model().hand->is_let_go);
    bench.perform(LetGo{false});
    REQUIRE(turn_until(bench, [&] { return step().in_contact && glm::length(step().force_n) > 0.01; }));

    // Tools act at the middle of the touched object, if that is set.
    CHECK(bench.model().tool_voxel == bench.model().probe_voxel);
    bench.perform(Set{R"({"probe":{"touch":{"at_proxy":true}}})"});
    REQUIRE(turn_until(bench, [&] {
        const glm::dvec3 tool = bench.model().tool_voxel;
        return tool == step().middle && tool != bench.model().probe_voxel;
    }));

    // Nothing is painted yet, so a group holds nothing to be felt.
    bench.perform(Set{R"({"probe":{"touch":{"groups":[3]}}})"});
    REQUIRE(turn_until(bench, [&] { return !step().in_contact && !(step().flags & FORCE_NO_REGION); }));
    bench.perform(Set{R"({"probe":{"touch":{"groups":[0]}}})"});
    REQUIRE(turn_until(bench, [&] { return step().in_contact; }));
    bench.perform(Set{R"({"probe":{"touch":{"strength":0}}})"});
    REQUIRE(turn_until(bench, [&] { return step().in_contact && glm::length(step().force_n) == 0.0; }));
}

TEST_CASE_FIXTURE(OnDevice, "a tool that acts at nodes links with one in the probe's ball and adds none beside it")
{
    TemporaryFolder folder;
    Workbench bench(renderer(), {.has_servo = false});
    bench.open(write_tubes_session(folder.path), {});
    bench.perform(NodeOp{.at = {10.0, 12.0, 14.0}, .radius_voxels = {}, .group = 2});
    bench.perform(NodeOp{.at = {20.0, 12.0, 14.0}, .radius_voxels = {}, .group = 2});
    bench.perform(NodeOp{.at = {20.0, 22.0, 14.0}, .radius_voxels = {}, .group = 2});
    bench.perform(Set{R"({"probe":{"radius_voxels":4}})"});
    bench.perform(PlaceProbe{{11.5, 12.0, 15.0}});
    CHECK(!bench.model().tool_node);
    bench.perform(of("to_nodes", bench));
    REQUIRE(bench.model().tool_node);
    CHECK(*bench.model().tool_node == 0);
    CHECK(bench.model().tool_voxel == glm::dvec3(10.0, 12.0, 14.0));
    bench.perform(of("add_node", bench));
    const TraceGraph& trace = bench.document().annotator.document().trace;
    CHECK(trace.nodes().size() == 3);
    CHECK(trace.internode_between(0, 2));
    bench.perform(of("add_node", bench));
    CHECK(trace.selection().node() == std::optional<uint32_t>(0));
    bench.perform(PlaceProbe{{30.0, 30.0, 20.0}});
    bench.perform(of("add_node", bench));
    CHECK(trace.nodes().size() == 4);
}

TEST_CASE_FIXTURE(OnDevice,
                  "a tool that acts on centre lines divides one in the probe's ball, and a click in a picture does")
{
    TemporaryFolder folder;
    Workbench bench(renderer(), {.has_servo = false});
    bench.set_pixels({96, 80});
    bench.open(write_tubes_session(folder.path), {});
    bench.perform(NodeOp{.at = {10.0, 12.0, 14.0}, .radius_voxels = {}, .group = 2});
    bench.perform(NodeOp{.at = {30.0, 12.0, 14.0}, .radius_voxels = {}, .group = 2});
    bench.perform(DeselectOp{});
    bench.perform(NodeOp{.at = {20.0, 22.0, 14.0}, .radius_voxels = {}, .group = 3});
    bench.perform(Set{R"({"probe":{"radius_voxels":4}})"});
    bench.perform(PlaceProbe{{19.0, 13.5, 15.0}});
    CHECK(!bench.model().tool_internode);
    bench.perform(of("to_lines", bench));
    CHECK(bench.messages().last() == "Tools act on a centre line in the probe's ball, and a new node divides it");
    REQUIRE(bench.model().tool_internode == 0u);
    CHECK(bench.model().tool_voxel == glm::dvec3(19.0, 12.0, 14.0));
    bench.perform(of("add_node", bench));
    CHECK(bench.messages().last() == "Node 3 divides internode 0, and is linked with node 2");
    const TraceGraph& trace = bench.document().annotator.document().trace;
    CHECK(trace.internodes().size() == 3);
    CHECK(trace.node(3).group == 2);
    // The lines of the node that tracing goes on from draw nothing, and a node at the end of another is that one.
    bench.perform(PlaceProbe{{22.0, 13.0, 14.0}});
    CHECK(!bench.model().tool_internode);
    bench.perform(SelectOp{.near = {}, .number = 2, .within_voxels = {}});
    CHECK(bench.model().tool_internode);
    bench.perform(PlaceProbe{{32.0, 12.0, 14.0}});
    CHECK(bench.model().tool_node == 1u);
    bench.perform(of("add_node", bench));
    CHECK(trace.internode_between(2, 1));
    CHECK(trace.nodes().size() == 4);
    bench.perform(UndoOp{2});
    CHECK(trace.internodes().size() == 1);
    CHECK(trace.internodes().contains(0));
    // A click on the line that is drawn is one on it, wherever the volume is seen there.
    bench.perform(LookFrom{"top"});
    REQUIRE(turn_until(bench, [&] { return bench.screen().complete(); }));
    const Pane seen = bench.screen().parts()[0].pane;
    const auto pixel = project(seen.shot.camera, seen.pixels(), {24.0, 12.0, 14.0});
    REQUIRE(pixel);
    bench.perform(Set{R"({"unpainted":{"opacity":0.01}})"});
    bench.perform(NodeAt{0, pixel->pixel});
    CHECK(trace.nodes().size() == 4);
    CHECK(bench.messages().last().find(" divides internode 0") != std::string::npos);
    const TraceNode& added = trace.node(*trace.selection().node());
    CHECK(glm::distance(added.position, glm::dvec3(24.0, 12.0, 14.0)) < 1e-6);
    CHECK(bench.document().touch.probe() == added.position);
    bench.perform(of("to_lines", bench));
    CHECK(bench.messages().last() == "Centre lines draw no tool");
}

TEST_CASE_FIXTURE(OnDevice,
                  "the volume moves with a stylus that has taken hold of it, and the probe stays on its voxel")
{
    TemporaryFolder folder;
    Workbench bench(renderer(), {});
    bench.set_pixels({48, 40});
    bench.open(write_tubes_session(folder.path), {});
    CHECK(bench.why_not(GrabVolume{true}) == "no stylus moves the probe");
    auto device = std::make_shared<SimulatedDevice>();
    Latest<HandWish>& wish = device->wish();
    wish.publish({.position_m = {0.01, 0.005, 0.0}, .buttons = 0, .jump = 1});
    bench.use_device(device, "a hand");
    const auto probe = [&] { return bench.document().touch.probe(); };
    const auto is_at = [&](double x) {
        return std::abs(bench.document().touch.last_state().device.position_m.x - x) < 1e-6;
    };
    REQUIRE(turn_until(bench, [&] { return is_at(0.01); }));
    turn_until(
        bench, [] { return false; }, 50);
    const glm::dvec3 before = probe();
    const Camera camera = bench.document().camera;
    // The second button takes hold.
    wish.publish({.position_m = {0.01, 0.005, 0.0}, .buttons = MOVE_BUTTON, .jump = 1});
    REQUIRE(turn_until(bench, [&] { return bench.model().hand->is_grabbing; }));
    wish.publish({.position_m = {0.03, 0.005, 0.0}, .buttons = MOVE_BUTTON, .jump = 1});
    REQUIRE(turn_until(bench, [&] { return is_at(0.03); }));
    turn_until(
        bench, [] { return false; }, 100);
    CHECK(glm::distance(probe(), before) < 1e-3);
    const glm::dvec3 moved = bench.document().camera.target - camera.target;
    const double height = bench.document().touch.last_state().device.position_m.x;  // 0.03 m
    CHECK(glm::dot(moved, axes_of(camera).right) < -1.0);
    CHECK(std::abs(glm::dot(moved, axes_of(camera).up)) < 1e-3 * glm::length(moved));
    CHECK(height > 0.0);
    wish.publish({.position_m = {0.03, 0.005, 0.0}, .buttons = 0, .jump = 1});
    REQUIRE(turn_until(bench, [&] { return !bench.model().hand->is_grabbing; }));
    const Camera left = bench.document().camera;
    wish.publish({.position_m = {0.0, 0.005, 0.0}, .buttons = 0, .jump = 1});
    REQUIRE(turn_until(bench, [&] { return is_at(0.0); }));
    CHECK(bench.document().camera.target == left.target);
}

TEST_CASE_FIXTURE(OnDevice, "a puck moves the view, or the probe by choice, and its silence is rest")
{
    TemporaryFolder folder;
    Workbench bench(renderer(), {});
    bench.set_pixels({48, 40});
    bench.open(write_tubes_session(folder.path), {});
    Latest<DeviceState> at;
    bench.use_device(std::make_shared<Puck>(at), "a puck");
    const Camera before = bench.document().camera;
    const glm::dvec3 probe = bench.model().probe_voxel;
    DeviceState state;
    state.rate = {0.5, 0.0, 0.0};
    at.publish(state);
    REQUIRE(turn_until(bench, [&] { return bench.document().camera.target != before.target; }));
    state.rate = glm::dvec3(0.0);
    state.position_m = {0.02, 0.0, 0.0};
    at.publish(state);
    turn_until(
        bench, [] { return false; }, 100);
    const Camera rest = bench.document().camera;
    CHECK(glm::dot(rest.target - before.target, axes_of(before).right) < 0.0);  // what is seen goes to the right
    turn_until(
        bench, [] { return false; }, 100);
    CHECK(bench.document().camera.target == rest.target);
    CHECK(bench.model().probe_voxel == probe);
    bench.perform(PlaceProbe{{11.0, 12.0, 13.0}});  // the mouse has the probe
    bench.advance();
    CHECK(bench.model().probe_voxel == glm::dvec3(11.0, 12.0, 13.0));

    bench.perform(Prefer{R"({"puck":"probe"})"});
    REQUIRE(turn_until(bench, [&] { return bench.model().hand->moves_probe; }));
    REQUIRE(turn_until(bench, [&] { return bench.model().probe_voxel != glm::dvec3(11.0, 12.0, 13.0); }));
    state.rate = {1.0, 0.0, 0.0};
    at.publish(state);
    turn_until(
        bench, [] { return false; }, 50);
    CHECK(bench.document().camera.target == rest.target);
}

TEST_CASE_FIXTURE(OnDevice,
                  "a session is recorded from the window through moves, paint and thresholds, and replays bit for bit "
                  "without its scan")
{
    TemporaryFolder folder;
    Workbench bench(renderer(), {});
    bench.open(write_tubes_session(folder.path), {});
    CHECK(bench.why_not(StopRecording{}) == "nothing is being recorded");
    bench.perform(Set{R"({"probe":{"guided":true,"touch":{"mode":"object"}}})"});
    bench.perform(of("record_stylus", bench));
    CHECK(bench.model().hand->recording == folder.path / "scan-stylus-1.trace");
    REQUIRE(turn_until(bench, [&] { return bench.model().hand->recorded_s.value_or(0.0) > 0.5; }));
    bench.perform(PlaceProbe{{21.0, 18.0, 16.0}});
    const auto record_until = [&](double seconds) {
        REQUIRE(turn_until(bench, [&] { return bench.model().hand->recorded_s.value_or(0.0) > seconds; }));
    };
    record_until(1.0);
    bench.perform(Set{R"({"probe":{"haptic_threshold":120}})"});
    record_until(1.3);
    bench.perform(Paint{true});
    bench.perform(PlaceProbe{{19.0, 17.0, 16.0}});
    bench.perform(Paint{false});
    record_until(1.6);
    bench.perform(Set{R"({"probe":{"touch":{"mode":"proximity","groups":[1]}}})"});
    record_until(1.9);
    bench.perform(Set{R"({"probe":{"touch":{"mode":"surface","groups":[]}}})"});
    bench.perform(PlaceProbe{{12.0, 16.0, 16.0}});
    record_until(2.2);
    bench.perform(of("record_stylus", bench));
    const std::filesystem::path file = folder.path / "scan-stylus-1.trace";
    REQUIRE(turn_until(bench, [&] { return std::filesystem::exists(file); }));
    CHECK(!bench.model().hand->recorded_s);
    const Trace trace = read_trace(file);
    CHECK(trace.ticks.size() > 900);
    CHECK(trace.unit == "voxel");
    // It begins without force, and guides as soon as it is known what can be felt.
    CHECK(!trace.settings.front().force.assistance);
    CHECK(trace.settings.back().force.assistance);
    CHECK(trace.settings.back().force.mode == TouchMode::surface);
    CHECK(trace.relevance.size() >= 3);
    const ReplayResult once = replay_trace(trace, {}, {});
    CHECK(once.told == trace.ticks.size());
    CHECK(once.told_equal == once.told);
    CHECK(once.largest_force_n > 0.02);
    const double minutes = double(trace.ticks.size()) / 60e3;
    size_t runs = 0;
    for (const TraceRelevance& noted : trace.relevance) runs += noted.runs.size();
    MESSAGE(trace.relevance.size(), " cubes, ", double(runs) / minutes * 1e-6, " MB a minute of ",
            double(std::filesystem::file_size(file)) / minutes * 1e-6);
    // A record in which a cube is not the one that was felt does not.
    Trace broken = trace;
    for (TraceRelevance& noted : broken.relevance) noted.settings += 1;
    CHECK(replay_trace(broken, {}, {}).told_equal < once.told);
    Trace late = trace;
    for (TraceRelevance& noted : late.relevance) noted.from_tick += 3;
    CHECK(replay_trace(late, {}, {}).told_equal < once.told);
}

TEST_CASE_FIXTURE(OnDevice,
                  "a recording goes on while devices come instead of the mouse, and all of it replays bit for bit")
{
    TemporaryFolder folder;
    Workbench bench(renderer(), {});
    bench.open(write_tubes_session(folder.path), {});
    bench.perform(Set{R"({"probe":{"guided":true,"touch":{"mode":"object"}}})"});
    bench.perform(PlaceProbe{{21.0, 18.0, 16.0}});
    bench.perform(of("record_stylus", bench));
    const auto record_until = [&](double seconds) {
        REQUIRE(turn_until(bench, [&] { return bench.model().hand->recorded_s.value_or(0.0) > seconds; }));
    };
    record_until(0.6);
    bench.use_device(std::make_shared<SimulatedDevice>(MODELLED_HAND), "a hand");
    record_until(1.2);
    bench.use_device(std::make_shared<SimulatedDevice>(MOUSE_HAND), "another");
    record_until(1.8);
    bench.perform(of("record_stylus", bench));
    const std::filesystem::path file = folder.path / "scan-stylus-1.trace";
    REQUIRE(turn_until(bench, [&] { return std::filesystem::exists(file); }));
    const Trace trace = read_trace(file);
    REQUIRE(trace.swaps.size() == 2);
    CHECK(trace.swaps[0] > 400);
    CHECK(trace.swaps[1] > trace.swaps[0] + 400);
    CHECK(trace.ticks.size() > trace.swaps[1] + 400);
    CHECK(trace.later_caps.size() == 2);  // each has its own limits
    const ReplayResult once = replay_trace(trace, {}, {});
    CHECK(once.swaps == 2);
    CHECK(once.told == trace.ticks.size());
    CHECK(once.told_equal == once.told);
}

TEST_CASE_FIXTURE(OnDevice, "a recorded stylus is followed with the present guidance, and paints and traces")
{
    TemporaryFolder folder;
    Workbench bench(renderer(), {.has_servo = false});
    bench.open(write_tubes_session(folder.path), {});
    // A path that runs past a voxel that is felt.
    write_trace(folder.path / "path.trace", path_along_x({8.0, 18.0, 16.0}, 24.0, 3000));
    const Action follow =
        read_action(sentence(R"({"op":"follow_stylus","path":")", (folder.path / "path.trace").string(), "\"}"), "row");
    bench.perform(Set{R"({"probe":{"tool":"trace","radius_voxels":5,"guided":false}})"});
    bench.perform(follow);
    settle(bench);
    const TraceGraph& trace = bench.document().annotator.document().trace;
    const size_t alone = trace.nodes().size();
    REQUIRE(alone >= 2);
    const auto stray = [&](size_t from) {
        double most = 0.0;
        for (const auto& [number, node] : trace.nodes())
            if (number >= from) most = std::max(most, std::hypot(node.position.y - 18.0, node.position.z - 16.0));
        return most;
    };
    CHECK(stray(0) < 0.01);
    bench.perform(DeselectOp{});
    bench.perform(Set{R"({"probe":{"guided":true,"touch":{"at_proxy":true,"overlap_radius":true,"mode":"object"}}})"});
    bench.perform(follow);
    settle(bench);
    CHECK(trace.nodes().size() > alone);
    CHECK(stray(alone) > 0.2);  // drawn to what is felt
    const size_t steps = bench.model().undoable;
    bench.perform(Set{R"({"probe":{"tool":"paint","group":4}})"});
    bench.perform(follow);
    settle(bench);
    CHECK(bench.model().voxels_by_group[4] > 0);
    CHECK(bench.model().undoable == steps + 1);
    // A recording of another scan is refused in words.
    folder.write("other.trace", "{\"shvr_stylus_trace\":1,\"unit\":\"mm\"}\n{\"at\":[0,0,0]}\n");
    bench.perform(FollowStylus{folder.path / "other.trace"});
    settle(bench);
    CHECK(bench.messages().last().find("expected a recording of this scan") != std::string::npos);
}

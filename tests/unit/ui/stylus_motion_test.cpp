// Effects of stylus motions on view, probe and tools.

#include "engine/workbench/touch/stylus_motion.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include <doctest/doctest.h>

#include "engine/volume/grid.h"
#include "engine/workbench/edits/puck_moves.h"
#include "engine/workbench/models/hand_view.h"
#include "engine/workbench/touch/felt_relevance.h"

using namespace shvr;
using namespace shvr::ui;

namespace {

Camera some_camera()
{
    Camera camera;
    camera.eye = {40.0, -25.0, 90.0};
    camera.target = {10.0, 12.0, 7.0};
    camera.up = {0.2, 1.0, 0.1};
    return camera;
}

glm::dvec3 in_view(const Camera& camera, const glm::dvec3& point)
{
    const CameraAxes axes = axes_of(camera);
    const glm::dvec3 away = point - camera.target;
    return {glm::dot(axes.right, away), glm::dot(axes.up, away), -glm::dot(axes.forward, away)};
}

/// The camera after the motion that a puck requests, about its target.
Camera after(const Actions& actions, Camera camera, double height)
{
    for (const Action& action : actions) {
        if (const auto* move = action.as<Move>()) camera = moved(camera, height * move->heights);
        if (const auto* orbit = action.as<Orbit>())
            camera = orbited(camera, camera.target, orbit->right_degrees, orbit->up_degrees);
        if (const auto* roll = action.as<Roll>()) camera = rolled(camera, roll->degrees);
    }
    return camera;
}

}  // namespace

TEST_CASE("a volume that a stylus has taken hold of moves and turns in the view as the stylus does (eq. 4.9)")
{
    std::mt19937 random(49);
    const auto number = [&] { return double(random()) / 2147483648.0 - 1.0; };
    constexpr double UNITS_PER_M = 700.0, HEIGHT = UNITS_PER_M * WORKSPACE_M;
    for (int round = 0; round < 200; ++round) {
        const glm::dquat before_turn = glm::normalize(glm::dquat(number(), number(), number(), number()));
        const glm::dquat after_turn = glm::normalize(glm::dquat(number(), number(), number(), number()));
        const Grab grab{some_camera(), 0.05 * glm::dvec3(number(), number(), number()), before_turn};
        const glm::dvec3 now_m = 0.05 * glm::dvec3(number(), number(), number());
        const Camera camera = camera_of_grab(grab, now_m, after_turn, UNITS_PER_M);
        // M_volume = M_probe M_probe_start^-1 M_volume_start, written out in the view.
        const glm::dquat turn = after_turn * glm::inverse(before_turn);
        const glm::dvec3 point(30.0 * number(), 30.0 * number(), 30.0 * number());
        const glm::dvec3 expected =
            turn * (in_view(grab.camera, point) - UNITS_PER_M * grab.position_m) + UNITS_PER_M * now_m;
        CHECK(glm::distance(in_view(camera, point), expected) < 1e-9);
        CHECK(glm::distance(camera.eye, camera.target) ==
              doctest::Approx(glm::distance(grab.camera.eye, grab.camera.target)));
        // The probe stays on its voxel.
        const glm::dvec3 was = workspace_in_view(grab.camera, HEIGHT, 1.0).to_point(grab.position_m);
        CHECK(glm::distance(workspace_in_view(camera, HEIGHT, 1.0).to_point(now_m), was) < 1e-9);
    }
}

TEST_CASE("what is seen follows a puck, and rests with it")
{
    const Camera camera = some_camera();
    const glm::dvec3 towards_us = camera.target - 5.0 * axes_of(camera).forward;
    const glm::dvec3 to_the_right = camera.target + 5.0 * axes_of(camera).right;
    const auto moved_in_view = [&](const DeviceState& state, const glm::dvec3& point) {
        return in_view(after(moves_of_puck(state, 0.01), camera, 60.0), point) - in_view(camera, point);
    };
    DeviceState state;
    CHECK(moves_of_puck(state, 0.01).empty());
    for (int axis = 0; axis < 3; ++axis) {
        state = {};
        state.rate[axis] = 1.0;
        // A height of the view in a second.
        glm::dvec3 expected(0.0);
        expected[axis] = 0.01 * 60.0;
        // Moving the camera moves its target, too.
        const Camera moved_camera = after(moves_of_puck(state, 0.01), camera, 60.0);
        CHECK(glm::distance(in_view(moved_camera, camera.target), expected) < 1e-9);
    }
    state = {};
    state.turn_rate = {1.0, 0.0, 0.0};
    CHECK(moved_in_view(state, towards_us).y < -0.05);  // its upper side comes towards us, the near side goes down
    state.turn_rate = {0.0, 1.0, 0.0};
    CHECK(moved_in_view(state, towards_us).x > 0.05);
    state.turn_rate = {0.0, 0.0, 1.0};
    CHECK(moved_in_view(state, to_the_right).y > 0.05);
}

TEST_CASE("a plane of voxels in the device's frame is the same plane")
{
    const Workspace workspace = workspace_in_view(some_camera(), 80.0, 1.5);
    const glm::dvec3 on{3.0, 4.0, 5.0};
    CHECK(!plane_of(TouchPlane::none, on, workspace, 1).is_on);
    for (const TouchPlane plane : {TouchPlane::x, TouchPlane::y, TouchPlane::z}) {
        const PlaneHold hold = plane_of(plane, on, workspace, 1);
        const glm::dvec3 anywhere_m{0.02, -0.03, 0.011};
        const glm::dvec3 held_m = anywhere_m - hold.normal * glm::dot(hold.normal, anywhere_m - hold.point_m);
        const glm::dvec3 held = workspace.to_point(held_m);
        CHECK(glm::distance(held, in_plane(plane, on, workspace.to_point(anywhere_m))) < 1e-9);
    }
}

TEST_CASE("the radius of a tube through a ball is told by how much of the ball it fills")
{
    constexpr double BALL = 6.0;
    for (const double tube : {0.6, 2.0, 3.7, 5.5}) {
        int inside = 0, filled = 0;
        for (double x = -BALL; x < BALL; x += 0.1)
            for (double y = -BALL; y < BALL; y += 0.1)
                for (double z = -BALL; z < BALL; z += 0.1) {
                    if (x * x + y * y + z * z > BALL * BALL) continue;
                    ++inside;
                    filled += y * y + z * z <= tube * tube;
                }
        CHECK(*radius_from_overlap(double(filled) / inside, BALL) == doctest::Approx(tube).epsilon(0.02));
    }
    CHECK(*radius_from_overlap(1.0, BALL) == doctest::Approx(BALL));
    CHECK(!radius_from_overlap(0.0, BALL));
}

TEST_CASE(
    "tools act at a node or a centre line in the ball if that is wanted, at nodes first, and at no line that goes on")
{
    TraceGraph trace;
    const auto apply = [&](const TraceChange& change) { trace.apply(change, Direction::forwards); };
    apply(TraceNodeChange{0, {}, TraceNode{{0, 0, 0}}});
    apply(TraceNodeChange{1, {}, TraceNode{{10, 0, 0}}});
    apply(TraceInternodeChange{0, {}, TraceInternode{0, 1}});
    FeelSettings feel;
    const glm::dvec3 beside(3, 1, 0), beyond(-1, 0, 0), far(5, 4, 0);
    const auto at = [&](const glm::dvec3& point, std::optional<uint32_t> except = {}) {
        return tool_place(feel, trace, point, 3.5, except);
    };
    CHECK(at(beside).point == beside);
    feel.to_lines = true;
    CHECK(at(beside).point == glm::dvec3(3, 0, 0));
    CHECK(at(beside).internode == 0u);
    CHECK(!at(beside).node);
    CHECK(at(beyond).node == 0u);  // an end of a line is a node
    CHECK(!at(beyond).internode);
    CHECK(at(far).point == far);
    CHECK(at(beside, 1u).point == beside);  // tracing goes on from there
    feel.to_nodes = true;
    CHECK(at(beside).node == 0u);
    CHECK(at(glm::dvec3(5, 1, 0)).internode == 0u);
}

// Kind (Touch): nodes and centre lines of hidden groups
TEST_CASE("nodes and centre lines in groups that are not drawn draw no tool, even where they are nearest")
{
    TraceGraph trace;
    const auto apply = [&](const TraceChange& change) { trace.apply(change, Direction::forwards); };
    apply(TraceNodeChange{0, {}, TraceNode{{0, 0, 0}, 1.0, 7}});
    apply(TraceNodeChange{1, {}, TraceNode{{10, 0, 0}, 1.0, 7}});
    apply(TraceInternodeChange{0, {}, TraceInternode{0, 1, 7}});
    apply(TraceNodeChange{2, {}, TraceNode{{0, 2, 0}, 1.0, 8}});
    apply(TraceNodeChange{3, {}, TraceNode{{10, 2, 0}, 1.0, 8}});
    apply(TraceInternodeChange{1, {}, TraceInternode{2, 3, 8}});
    FeelSettings feel;
    std::bitset<256> drawn;
    drawn.set();
    const auto at = [&](const glm::dvec3& point) { return tool_place(feel, trace, point, 3.5, {}, drawn); };
    feel.to_lines = true;
    CHECK(at({4, 0.5, 0}).internode == 0u);
    drawn.reset(7);
    CHECK(at({4, 0.5, 0}).internode == 1u);
    CHECK(at({4, 0.5, 0}).point == glm::dvec3(4, 2, 0));
    drawn.reset(8);
    CHECK(at({4, 0.5, 0}).point == glm::dvec3(4, 0.5, 0));
    feel.to_nodes = true;
    drawn.set();
    CHECK(at({1, 0.5, 0}).node == 0u);
    drawn.reset(7);
    CHECK(at({1, 0.5, 0}).node == 2u);
    drawn.reset(8);
    CHECK(!at({1, 0.5, 0}).node);
}

TEST_CASE("groups that are not felt are no part of what is felt")
{
    Mask mask(Size3(70, 40, 33));
    std::mt19937 random(7);
    std::map<int64_t, std::vector<std::pair<uint16_t, uint8_t>>> painted;
    for (int i = 0; i < 4000; ++i) {
        const Size3 voxel(random() % 70, random() % 40, random() % 33);
        painted[index_of(voxel / BRICK_SIDE, mask.brick_counts())].emplace_back(uint16_t(index_in_brick(voxel)),
                                                                                uint8_t(1 + random() % 3));
    }
    for (auto& [brick, voxels] : painted) {
        std::ranges::sort(voxels);
        MaskBrickChange change{.brick = brick, .runs = {}};
        for (const auto& [at, group] : voxels)
            if (change.runs.empty() || change.runs.back().last < at)
                change.runs.push_back({.first = at, .last = at, .before = 0, .after = group});
        mask.apply(change, Direction::forwards);
    }
    const VoxelBox box{Size3(4, 3, 2), Size3(68, 39, 33)};
    const Size3 size = box.size();
    const int64_t words_per_row = (size.x + 31) / 32;
    std::vector<uint32_t> words(size_t(words_per_row * size.y * size.z));
    for (uint32_t& word : words) word = uint32_t(random());
    const auto is_set = [&](const std::vector<uint32_t>& of, const Size3& v) {
        return of[size_t(v.x / 32 + words_per_row * (v.y + size.y * v.z))] >> (v.x % 32) & 1u;
    };
    for (const std::vector<uint8_t>& felt :
         {std::vector<uint8_t>{}, std::vector<uint8_t>{2}, std::vector<uint8_t>{0, 3}}) {
        RelevanceBits bits{.box = box, .words_per_row = words_per_row, .words = words};
        apply_limits(limits_of_groups(felt), glm::dvec3(1.0), &mask, bits);
        const std::vector<uint32_t>& kept = bits.words;
        int wrong = 0;
        for (int64_t z = 0; z < size.z; ++z)
            for (int64_t y = 0; y < size.y; ++y)
                for (int64_t x = 0; x < size.x; ++x) {
                    const uint8_t group = mask.at(box.lower + Size3(x, y, z));
                    const bool is_felt = felt.empty() || std::ranges::find(felt, group) != felt.end();
                    wrong += is_set(kept, {x, y, z}) != (is_felt ? is_set(words, {x, y, z}) : 0u);
                }
        CHECK(wrong == 0);
    }
}

TEST_CASE("states of a device are told in words, the gravest first")
{
    HandView hand;
    hand.moves_probe = true;
    ServoState servo;
    servo.caps.outputs_force = true;
    CHECK(findings_of(hand, servo, true).empty());
    servo.step.flags = FORCE_ENGAGING | FORCE_WARM;
    REQUIRE(findings_of(hand, servo, true).size() == 2);
    CHECK(findings_of(hand, servo, true)[0].text.starts_with("The motors are warm"));
    CHECK(findings_of(hand, servo, false).empty());  // where no force is wanted there is none to explain
    servo.device.calibrated = false;
    hand.trouble = "the service has ended";
    const std::vector<Finding> grave = findings_of(hand, servo, false);
    REQUIRE(grave.size() == 2);
    CHECK(grave[0] == Finding{Weight::error, "the service has ended"});
    CHECK(grave[1].text.find("not calibrated") != std::string::npos);
    CHECK(realtime_in_words(true, 0).weight == Weight::done);
    CHECK(realtime_in_words(false, 0).text.find("rtprio") != std::string::npos);
    CHECK(heat_in_words(0.2, servo.caps) == "cool, 20 % of the motors' continuous limit");
    CHECK(heat_in_words(0.97, servo.caps).starts_with("hot"));
    servo.caps.outputs_force = false;
    CHECK(heat_in_words(0.97, servo.caps).empty());
    CHECK(name_in_words("Touch", "2871") == "Touch (serial 2871)");

    DeviceListing row;
    row.kind = DeviceKind::hid;
    row.id = "hid:a";
    row.has_force = true;
    CHECK(state_in_words(row, hand) == "can push the hand");
    row.why_unusable = "it cannot be opened";
    CHECK(state_in_words(row, hand) == "it cannot be opened");
    hand.in_use = "hid:a";
    CHECK(state_in_words(row, hand) == "moves the probe");
}

// Thin sheets: the force they hold, and that crossing at any speed is no jolt. A probe of ten voxels, 2.5 mm in the
// hand, at the default stiffness.

#include <cmath>
#include <memory>

#include <doctest/doctest.h>

#include "haptics/force.h"
#include "haptics/replay/modelled_touch.h"
#include "tests/support/haptic_scenes.h"

using namespace shvr;

namespace {

constexpr uint64_t MILLISECOND = 1'000'000;
constexpr double VOXEL_MM = 0.25, MIDDLE = 8.0;

/// Across z, `voxels` thick, from the middle of a cube of 64 voxels on.
std::unique_ptr<RelevancePatch> sheet(int voxels)
{
    auto patch = std::make_unique<RelevancePatch>();
    fill_patch(*patch, {0, 0, 0}, glm::ivec3(64), glm::dvec3(VOXEL_MM),
               [&](const glm::dvec3& p) { return p.z >= MIDDLE && p.z < MIDDLE + voxels * VOXEL_MM; });
    patch->volume_size = glm::ivec3(64);
    patch->time_ns = ~uint64_t{0};
    return patch;
}

struct Hand {
    ForceSettings settings{.assistance = true, .probe_radius = 2.5};
    DeviceCaps caps{.usable_lower_m = glm::dvec3(-1.0), .usable_upper_m = glm::dvec3(1.0), .outputs_force = true};
    std::unique_ptr<RelevancePatch> patch;
    std::unique_ptr<GrowthMemory> growth = std::make_unique<GrowthMemory>();
    ForceMemory memory;
    uint64_t now_ns = 0;

    Hand(int voxels, TouchMode mode) : patch(sheet(voxels))
    {
        settings.workspace = {glm::dmat3(1000.0), glm::dvec3(MIDDLE)};
        settings.mode = mode;
        memory.engagement = memory.strength = memory.relevance_fade = 1.0;
        memory.has_begun = true;
    }
    ForceStep tick(const DeviceState& state)
    {
        now_ns += MILLISECOND;
        const bool is_first = !memory.has_last;
        const ForceStep now = step(settings, caps, ReadResult::fresh, state, *patch, now_ns, memory, *growth);
        if (is_first) memory.engagement = 1.0, memory.has_begun = true;
        return now;
    }
    /// The largest force towards the sheet at any distance, by the law alone.
    double holding_n()
    {
        double most = 0.0;
        for (double z = MIDDLE; z < MIDDLE + 3.2; z += 0.01) {
            const Proxy proxy = find_proxy(*patch, {8.1, 7.9, z}, settings.probe_radius, settings.law);
            most = std::max(most, -proxy.offset.z * 1e-3 * stiffness_at_hand(settings, caps, memory.sent));
        }
        return most;
    }
};

}  // namespace

TEST_CASE("a sheet of one voxel holds a hand up to 0.3 N and one of two up to 0.5 N: none is popped through below")
{
    for (const int voxels : {1, 2}) {
        for (const TouchMode mode : {TouchMode::proximity, TouchMode::object}) {
            CAPTURE(voxels);
            CAPTURE(int(mode));
            Hand hand(voxels, mode);
            const double holding_n = hand.holding_n();
            CHECK(holding_n > (voxels == 1 ? 0.3 : 0.5));
            // A hand without friction that draws ever more, 1 mm/s.
            TouchModel model{.coulomb_n = 0.0};
            ModelledTouch device(model);
            const double begin_m = 0.5 * voxels * VOXEL_MM * 1e-3;
            HandWish wish{.position_m = {0.0, 0.0, begin_m}, .buttons = 0, .jump = 1};
            double pulled_n = 0.0, least_n = 1e9;
            for (int tick = 0; tick < 9000; ++tick) {
                if (tick > 200) wish.position_m.z += 1e-6;
                device.wish().publish(wish);
                DeviceState state;
                device.read(state);
                const ForceStep now = hand.tick(state);
                device.write(now.force_n, now.sequence);
                const double away_m = device.true_position_m().z - begin_m;
                pulled_n = model.hand_stiffness * (wish.position_m.z - device.true_position_m().z);
                if (away_m > 2.5e-3 + begin_m) least_n = std::min(least_n, pulled_n + 1.0);  // it is off
                if (away_m < 2.0e-3) least_n = std::max(pulled_n, least_n == 1e9 ? 0.0 : least_n);
            }
            MESSAGE(voxels, " voxels: the law holds ", holding_n, " N, the hand came off at ", least_n, " N");
            CHECK(least_n >= 0.9 * holding_n);
            CHECK(least_n <= 1.25 * holding_n);
        }
    }
}

TEST_CASE("sheets crossed at up to 50 mm/s change the force by at most 0.05 N a tick; none more than slew")
{
    for (const int voxels : {1, 2}) {
        for (const TouchMode mode : {TouchMode::proximity, TouchMode::object, TouchMode::surface}) {
            for (const double speed : {0.005, 0.02, 0.05, 0.2, 0.5}) {
                CAPTURE(voxels);
                CAPTURE(int(mode));
                CAPTURE(speed);
                Hand hand(voxels, mode);
                DeviceState state;
                glm::dvec3 last(0.0);
                double largest = 0.0, most = 0.0;
                for (int tick = 0;; ++tick) {
                    ++state.sequence;
                    state.time_ns += MILLISECOND;
                    state.position_m.z = 0.005 - speed * tick * 1e-3;
                    if (state.position_m.z < -0.005) break;
                    const ForceStep now = hand.tick(state);
                    largest = std::max(largest, glm::distance(now.force_n, last));
                    most = std::max(most, glm::length(now.force_n));
                    last = now.force_n;
                }
                if (mode != TouchMode::surface) CHECK(most > 0.05);
                CHECK(largest <= (speed <= 0.05 ? 0.05 + 1e-9 : SLEW_N + 1e-12));
            }
        }
    }
}

TEST_CASE("the law alone, without the limit of slew, changes by at most 0.062 N in 0.05 mm at a sheet")
{
    constexpr double STEP_MM = 0.05;
    for (const int voxels : {1, 2}) {
        CAPTURE(voxels);
        Hand hand(voxels, TouchMode::proximity);
        double largest = 0.0, last = 0.0;
        for (double z = MIDDLE - 3.2; z < MIDDLE + 3.7; z += STEP_MM) {
            const Proxy proxy = find_proxy(*hand.patch, {8.1, 7.9, z}, hand.settings.probe_radius, hand.settings.law);
            const double force = proxy.offset.z * 1e-3 * stiffness_at_hand(hand.settings, hand.caps, hand.memory.sent);
            largest = std::max(largest, std::abs(force - last));
            last = force;
        }
        MESSAGE(voxels, " voxels: ", largest, " N in ", STEP_MM, " mm");
        CHECK(largest > 0.01);
        CHECK(largest <= 0.062);
    }
}

TEST_CASE(
    "a surface that is thinner than its share of the ball does not hold, and one that does lets go where little "
    "of it is left")
{
    // Ten voxels: one or two are 7 to 15 % of the ball, at most.
    for (const int voxels : {1, 2}) {
        Hand hand(voxels, TouchMode::surface);
        DeviceState state;
        double most = 0.0;
        for (int tick = 0; tick < 500; ++tick) {
            ++state.sequence;
            state.time_ns += MILLISECOND;
            state.position_m.z = 0.005 - 2e-5 * tick;
            most = std::max(most, glm::length(hand.tick(state).force_n));
        }
        CHECK(most == 0.0);
    }
    // A probe of one voxel is held by a sheet of two up to what the spring has where less than 30 % of the ball is
    // left.
    Hand hand(2, TouchMode::surface);
    hand.settings.probe_radius = VOXEL_MM;
    DeviceState state;
    double most = 0.0, held_to = 0.0;
    for (int tick = 0; tick < 2000; ++tick) {
        ++state.sequence;
        state.time_ns += MILLISECOND;
        state.position_m.z = 0.001 - 1e-6 * tick;
        const double now = hand.tick(state).force_n.z;
        if (now > most) most = now, held_to = state.position_m.z;
    }
    MESSAGE("two voxels hold a probe of one voxel to ", most, " N, ", 1e3 * held_to, " mm");
    CHECK(most >= 0.15);
    CHECK(held_to < 0.25e-3);
}

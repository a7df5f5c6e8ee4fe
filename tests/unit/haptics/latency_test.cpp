// Relevance that comes late: what the border of a region does to the force, and how well a hand is guided whatever the
// probe's radius, its speed and the latency.

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "haptics/force.h"
#include "haptics/replay/late_relevance.h"
#include "haptics/simulated_device.h"
#include "tests/support/haptic_scenes.h"
#include "tests/support/slow.h"

using namespace shvr;

namespace {

constexpr double PROBE_MM = 2.5;  ///< in the hand, whatever its voxels
constexpr uint64_t MILLISECOND = 1'000'000;

Rod rod_along(const glm::dvec3& direction, double radius)
{
    return {.point = {96.3, 96.2, 95.7}, .direction = glm::normalize(direction), .radius = radius};
}

/// The middle 64 voxels a side of a volume of 192.
void fill_middle(const Rod& rod, RelevancePatch& patch)
{
    fill_patch(patch, glm::ivec3(64), glm::ivec3(64), glm::dvec3(1), [&](const glm::dvec3& p) { return rod.holds(p); });
    patch.volume_size = glm::ivec3(192);
}

/// Largest force along a straight tube, N, on a hand that leaves the region on the tube's axis.
double force_along(const glm::dvec3& direction, double speed, ProxyLaw law)
{
    constexpr double RADIUS = 10.0, VOXEL_M = PROBE_MM * 1e-3 / RADIUS;
    constexpr int REST = 1500;
    const Rod rod = rod_along(direction, 4.0);
    const auto patch = std::make_unique<RelevancePatch>();
    fill_middle(rod, *patch);
    const auto growth = std::make_unique<GrowthMemory>();
    ForceMemory memory;
    ForceSettings settings{.assistance = true, .law = law, .probe_radius = RADIUS, .damping = 0.0};
    settings.workspace = {glm::dmat3(1.0 / VOXEL_M), glm::dvec3(96.0)};
    const DeviceCaps caps{.usable_lower_m = glm::dvec3(-1.0), .usable_upper_m = glm::dvec3(1.0), .outputs_force = true};
    double most = 0.0;
    for (int tick = 0; tick < REST + 4000; ++tick) {
        const double away = speed * 1e-3 * std::max(0, tick - REST) / VOXEL_M;
        const glm::dvec3 probe = rod.point + rod.direction * away;
        if (glm::distance(probe, rod.point) > 60.0) break;
        DeviceState state;
        state.time_ns = patch->time_ns = uint64_t(tick + 1) * MILLISECOND;
        state.sequence = uint32_t(tick);
        state.position_m = (probe - 96.0) * VOXEL_M;
        const ForceStep now = step(settings, caps, ReadResult::fresh, state, *patch, state.time_ns, memory, *growth);
        most = std::max(most, std::abs(glm::dot(now.force_n, rod.direction)));
    }
    return most;
}

/// Voxels around a probe, of a tube along x in a volume that is long enough; the place is that of
/// engine/live/relevance_host.h.
void cut_ahead(const Rod& rod, const RegionWish& wish, RelevancePatch& patch)
{
    constexpr glm::ivec3 VOLUME(4096, 512, 512);
    const double ahead = wish.radius + glm::length(wish.travel());
    patch.level = 0;
    while (ahead / (1 << patch.level) + 1.0 > 64.0 && wish.radius / (2 << patch.level) >= 12.0) ++patch.level;
    const int voxel = 1 << patch.level;
    const double needs = ahead / voxel + 1.0;
    const int side = wish.radius / voxel > 24.0 ? 128 : needs <= 32.0 ? 64 : needs <= 48.0 ? 96 : 128;
    const glm::dvec3 middle = wish.region_middle(glm::dvec3(0.5 * side * voxel)) / double(voxel);
    patch.volume_size = VOLUME / voxel;
    patch.origin = glm::clamp(glm::ivec3(glm::round(middle)) - side / 2, glm::ivec3(0), patch.volume_size - side);
    patch.size = glm::ivec3(side);
    patch.spacing = glm::dvec3(voxel);
    patch.words_per_row = side / 32;
    std::fill_n(patch.words.begin(), patch.word_count(), 0u);
    const int reach = int(rod.radius / voxel) + 3;
    for (int x = 0; x < side; ++x) {  // only near the axis
        const double along = ((patch.origin.x + x + 0.5) * voxel - rod.point.x) / rod.direction.x;
        const glm::ivec3 near = glm::ivec3((rod.point + rod.direction * along) / double(voxel)) - patch.origin;
        for (int z = std::max(0, near.z - reach); z < std::min(side, near.z + reach); ++z)
            for (int y = std::max(0, near.y - reach); y < std::min(side, near.y + reach); ++y)
                if (rod.holds((glm::dvec3(patch.origin + glm::ivec3(x, y, z)) + 0.5) * double(voxel)))
                    patch.words[size_t(x / 32 + patch.words_per_row * (y + side * z))] |= 1u << (x % 32);
    }
}

struct Sweep {
    double radius = 0.0;  ///< voxels
    double speed = 0.0;   ///< mm/s in the hand
    double latency_s = 0.0;
};

/// RMS lateral error in the hand, mm, of one that goes to and fro along a tube and wanders as hands do.
double follow(const Sweep& sweep, bool is_guided)
{
    constexpr int ENGAGED = 1500, TICKS = 3500;
    constexpr double SPAN_VOXELS = 3000.0;
    const double voxel_mm = PROBE_MM / sweep.radius;
    const Rod rod{.point = {0.0, 150.0, 160.0},
                  .direction = glm::normalize(glm::dvec3(1.0, 0.02, 0.015)),
                  .radius = 0.4 * sweep.radius};
    std::mt19937 random(1);
    std::array<glm::dvec3, 3> phases;
    for (glm::dvec3& p : phases)
        for (int axis = 0; axis < 3; ++axis) p[axis] = 2.0 * std::numbers::pi * double(random()) / 4294967296.0;
    SimulatedDevice device(MODELLED_HAND);
    const auto growth = std::make_unique<GrowthMemory>();
    ForceMemory memory;
    ForceSettings settings{.assistance = is_guided, .probe_radius = sweep.radius, .mode = TouchMode::object};
    settings.workspace = {glm::dmat3(1000.0 / voxel_mm), glm::dvec3(0.0)};
    DeviceCaps caps = device.caps();
    caps.usable_lower_m = glm::dvec3(-100.0);
    caps.usable_upper_m = glm::dvec3(100.0);
    LateRelevance relevance([&](const RegionWish& wish, double, RelevancePatch& patch) { cut_ahead(rod, wish, patch); },
                            sweep.latency_s);
    ForceStep now;
    double squares = 0.0;
    for (int tick = 0; tick < TICKS; ++tick) {
        const double t = tick * 1e-3;
        const auto swing = [&](size_t which, double amplitude, double hertz) {
            return std::min(t, 1.0) * amplitude * glm::sin(2.0 * std::numbers::pi * hertz * t + phases[which]);
        };
        const glm::dvec3 wander = (swing(0, 1.5, 0.45) + swing(1, 0.7, 1.1) + swing(2, 0.06, 9.0)) / voxel_mm;
        const double run = std::fmod(sweep.speed / voxel_mm * std::max(0.0, t - 1.2), 2.0 * SPAN_VOXELS);
        const double along = 300.0 + (run < SPAN_VOXELS ? run : 2.0 * SPAN_VOXELS - run);
        device.wish().publish(
            {.position_m = (rod.point + rod.direction * along + wander) * voxel_mm * 1e-3, .buttons = 0, .jump = 1});
        DeviceState state;
        device.read(state);
        const glm::dvec3 probe = settings.workspace.to_point(state.position_m);
        const uint64_t now_ns = uint64_t(tick + 1) * MILLISECOND;
        const RelevancePatch& patch = relevance.around(now.velocity, probe, settings, 1.0, now_ns);
        now = step(settings, caps, ReadResult::fresh, state, patch, now_ns, memory, *growth);
        device.write(now.force_n, now.sequence);
        if (tick < ENGAGED) continue;
        const glm::dvec3 away = probe - rod.point;
        const glm::dvec3 lateral = (away - rod.direction * glm::dot(away, rod.direction)) * voxel_mm;
        squares += glm::dot(lateral, lateral);
    }
    return std::sqrt(squares / (TICKS - ENGAGED));
}

}  // namespace

TEST_CASE("on a straight tube's axis nothing pulls along it where the region ends")
{
    const auto patch = std::make_unique<RelevancePatch>();
    for (const glm::dvec3& direction :
         {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, -1), glm::dvec3(2, 1, -1)}) {
        for (const double radius : {6.0, 10.0, 20.0}) {
            const Rod rod = rod_along(direction, 0.4 * radius);
            fill_middle(rod, *patch);
            for (const ProxyLaw law : {ProxyLaw::potential, ProxyLaw::mean}) {
                CAPTURE(direction.x);
                CAPTURE(direction.y);
                CAPTURE(radius);
                double most = 0.0, jump = 0.0, beside = 0.0;
                glm::dvec3 last(0.0);
                const glm::dvec3 across = glm::normalize(glm::cross(rod.direction, glm::dvec3(0.3, 0.5, 0.7)));
                for (double away = 0.0; away < 50.0; away += 0.05) {
                    const glm::dvec3 at = rod.point + rod.direction * away;
                    const Proxy proxy = find_proxy(*patch, at, radius, law);
                    most = std::max(most, std::abs(glm::dot(proxy.offset, rod.direction)));
                    if (away > 0.0) jump = std::max(jump, glm::distance(proxy.offset, last));
                    last = proxy.offset;
                    // Off the axis, the pull back to it stays, by the known share.
                    const glm::dvec3 off = at + 0.2 * radius * across;
                    const double share = patch->known_part(off, radius).share;
                    if (share == 0.0) continue;
                    const Proxy pulled = find_proxy(*patch, off, radius, law);
                    if (share > 0.5) beside = std::max(beside, std::abs(glm::dot(pulled.mean, across) / radius + 0.2));
                }
                MESSAGE("radius ", radius, ": ", most / radius, " along, ", jump / radius, " a step, ", beside,
                        " beside");
                CHECK(most <= 0.02 * radius);
                CHECK(jump <= 0.02 * radius);
                CHECK(beside <= 0.08);
                CHECK(last == glm::dvec3(0.0));
            }
        }
    }
}

// Kind (Touch): a hand that is faster than the relevance
TEST_CASE("a region that is not renewed does not pull a hand back along a straight tube")
{
    for (const glm::dvec3& direction : {glm::dvec3(1, 0, 0), glm::dvec3(2, 1, -1)})
        for (const ProxyLaw law : {ProxyLaw::potential, ProxyLaw::mean, ProxyLaw::thesis})
            for (const double speed : {0.05, 0.2, 0.5}) {
                CAPTURE(int(law));
                CAPTURE(speed);
                const double most = force_along(direction, speed, law);
                CHECK(most <= (law == ProxyLaw::thesis ? 0.06 : 0.02));  // 3000 random points are not symmetric
            }
}

TEST_CASE("a region that ends at the volume's border is known to be empty beyond it")
{
    const auto patch = std::make_unique<RelevancePatch>();
    fill_middle(rod_along({1, 0, 0}, 4.0), *patch);
    CHECK(patch->known_part({120.0, 96.0, 96.0}, 10.0).share < 1.0);
    patch->volume_size = glm::ivec3(128);
    CHECK(patch->known_part({120.0, 96.0, 96.0}, 10.0).share == 1.0);
    CHECK(patch->known_part({300.0, 96.0, 96.0}, 10.0).share == 1.0);
    patch->volume_size = glm::ivec3(192);
    // One plane at half of the radius: (3 s - s^3) / 2 of the ball between it and its mirror image.
    CHECK(patch->known_part({123.0, 96.0, 96.0}, 10.0).share == doctest::Approx(0.6875));
    CHECK(patch->known_part({128.0, 96.0, 96.0}, 10.0).share == 0.0);
    CHECK(patch->known_part({std::nan(""), 96.0, 96.0}, 10.0).share == 0.0);
}

// Kind (Touch): large and fast probes with late relevance
TEST_CASE("guidance stays above its bound for every radius, speed and latency of the sweep")
{
    using List = std::vector<double>;
    // Half of the lateral error: turning round at 200 mm/s costs the largest ball most. Elsewhere it is 69 % and more.
    constexpr double BOUND = 0.5;
    const double free_mm = follow({6.0, 20.0, 0.0}, false);  // in the hand, the same for all
    for (const double radius : test::repeats(List{6.0, 24.0, 48.0}, List{6.0, 12.0, 24.0, 48.0})) {
        for (const double speed : test::repeats(List{50.0, 200.0}, List{20.0, 50.0, 100.0, 200.0})) {
            for (const double latency_s :
                 test::repeats(List{WINDOW_LATENCY_S, 0.05}, List{0.0, WINDOW_LATENCY_S, 0.05})) {
                CAPTURE(radius);
                CAPTURE(speed);
                CAPTURE(latency_s);
                const double taken = 1.0 - follow({radius, speed, latency_s}, true) / free_mm;
                MESSAGE("radius ", radius, ", ", speed, " mm/s, ", 1e3 * latency_s, " ms: ", 100.0 * taken, " %");
                CHECK(taken >= BOUND);
                CHECK((taken >= 0.69 || (radius == 48.0 && speed == 200.0)));
            }
        }
    }
}

// Guidance along a tube: how much closer to its middle line a hand and a mouse stay with assistance than without: for a
// lone tube, in noise, near a neighbour and with one that touches. Relevance is as late as in the window.

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "haptics/force.h"
#include "haptics/replay/late_relevance.h"
#include "haptics/simulated_device.h"
#include "tests/support/haptic_scenes.h"
#include "tests/support/slow.h"

using namespace shvr;

namespace {

constexpr uint64_t MILLISECOND = 1'000'000;
constexpr double VOXEL_MM = 0.25, TUBE_MM = 1.0;
constexpr glm::ivec3 SIZE{520, 120, 120};
/// mm.
constexpr WindingLine LINE{15.0, 5.0, 20.0, 4.0, 16.0};

struct SceneKind {
    const char* name;
    double noise = 0.0;         ///< share of voxels that are wrong
    double neighbour_mm = 0.0;  ///< from middle line to middle line; 0: none
};
constexpr SceneKind SCENES[] = {
    {"alone"}, {"in noise", 0.02}, {"beside a neighbour", 0.0, 2.8}, {"beside a neighbour in noise", 0.02, 2.8}};
/// The tubes' sides touch; between them a scan is darker than in them.
constexpr SceneKind TOUCHING{"beside a tube that touches", 0.0, 2.0};

/// How bright a scan with a blur of 0.3 mm shows a tube at that distance from its middle.
double brightness(double distance_mm)
{
    return 0.5 * std::erfc((distance_mm - TUBE_MM) / (0.3 * std::numbers::sqrt2));
}

/// A byte for each voxel: at or above `threshold` of a tube's brightness.
std::vector<uint8_t> make_scene(const SceneKind& kind, double threshold)
{
    std::vector<uint8_t> scene(size_t(SIZE.x) * size_t(SIZE.y) * size_t(SIZE.z));
    std::mt19937 random(11);
    size_t at = 0;
    for (int z = 0; z < SIZE.z; ++z)
        for (int y = 0; y < SIZE.y; ++y)
            for (int x = 0; x < SIZE.x; ++x, ++at) {
                const glm::dvec3 p = (glm::dvec3(x, y, z) + 0.5) * VOXEL_MM;
                double bright = 0.0;
                for (const double away_mm : {0.0, kind.neighbour_mm}) {
                    const glm::dvec3 moved = p - glm::dvec3(0.0, 0.0, away_mm);
                    if (glm::distance(moved, LINE.at(moved.x)) > 4.0 * TUBE_MM) continue;
                    bright = std::max(bright, brightness(glm::length(LINE.towards(moved))));
                    if (kind.neighbour_mm == 0.0) break;
                }
                scene[at] = bright >= threshold;
                if (kind.noise > 0.0 && double(random()) < kind.noise * 4294967296.0) scene[at] ^= 1;
            }
    return scene;
}

void cut(const std::vector<uint8_t>& scene, const RegionWish& wish, RelevancePatch& patch)
{
    constexpr int SIDE = 64;
    const glm::dvec3 middle_mm = wish.region_middle(glm::dvec3(0.5 * SIDE * VOXEL_MM));
    const glm::ivec3 origin =
        glm::clamp(glm::ivec3(glm::round(middle_mm / VOXEL_MM)) - SIDE / 2, glm::ivec3(0), SIZE - SIDE);
    fill_patch(patch, origin, glm::ivec3(SIDE), glm::dvec3(VOXEL_MM), [&](const glm::dvec3& p) {
        const glm::ivec3 v(p / VOXEL_MM);
        return scene[size_t(v.x) + size_t(SIZE.x) * (size_t(v.y) + size_t(SIZE.y) * size_t(v.z))] != 0;
    });
    patch.volume_size = SIZE;
}

/// RMS distance of the probe from the middle line, mm: 20 mm/s along it, wandering as hands do.
double follow(const std::vector<uint8_t>& scene, const HandModel& hand, std::optional<TouchMode> mode)
{
    double squares = 0.0;
    int count = 0;
    for (const uint32_t seed : {1u, 2u, 3u}) {
        std::mt19937 random(seed);
        const auto phase = [&] { return 2.0 * std::numbers::pi * double(random()) / 4294967296.0; };
        std::array<glm::dvec3, 3> phases;
        for (glm::dvec3& p : phases) p = {phase(), phase(), phase()};
        SimulatedDevice device(hand);
        LateRelevance relevance([&](const RegionWish& wish, double, RelevancePatch& patch) { cut(scene, wish, patch); },
                                WINDOW_LATENCY_S);
        const auto growth = std::make_unique<GrowthMemory>();
        ForceMemory memory;
        ForceStep now;
        ForceSettings settings{.assistance = mode.has_value(), .probe_radius = 2.5};
        settings.workspace = {glm::dmat3(1000.0), glm::dvec3(0.0)};
        settings.mode = mode.value_or(TouchMode::proximity);
        DeviceCaps caps = device.caps();
        caps.usable_lower_m = glm::dvec3(-1.0);
        caps.usable_upper_m = glm::dvec3(1.0);
        for (int tick = 0; tick < 4500; ++tick) {
            const double t = tick * 1e-3;
            const auto swing = [&](size_t which, double amplitude, double hertz) {
                return std::min(t, 1.0) * amplitude * glm::sin(2.0 * std::numbers::pi * hertz * t + phases[which]);
            };
            const glm::dvec3 wander = swing(0, 1.5, 0.45) + swing(1, 0.7, 1.1) + swing(2, 0.06, 9.0);
            device.wish().publish({.position_m = (LINE.at(15.0 + 20.0 * t) + wander) * 1e-3, .buttons = 0, .jump = 1});
            DeviceState state;
            device.read(state);
            const glm::dvec3 probe = settings.workspace.to_point(state.position_m);
            const uint64_t now_ns = uint64_t(tick + 1) * MILLISECOND;
            const RelevancePatch& patch = relevance.around(now.velocity, probe, settings, 1.0, now_ns);
            now = step(settings, caps, ReadResult::fresh, state, patch, now_ns, memory, *growth);
            device.write(now.force_n, now.sequence);
            if (tick < 1500) continue;  // engaged by then
            const glm::dvec3 away = LINE.towards(probe);
            squares += glm::dot(away, away);
            ++count;
        }
    }
    return std::sqrt(squares / count);
}

}  // namespace

TEST_CASE("object following takes at least 60 % of the lateral error, and neighbours and noise cost it at most 5 %")
{
    std::array<double, 2> alone_mm{};
    for (const SceneKind& kind : SCENES) {
        const std::vector<uint8_t> scene = make_scene(kind, 0.5);
        for (const bool is_mouse : {false, true}) {
            const HandModel hand = is_mouse ? MOUSE_HAND : MODELLED_HAND;
            const double free_mm = follow(scene, hand, {}), guided_mm = follow(scene, hand, TouchMode::object);
            if (&kind == SCENES) alone_mm[is_mouse] = guided_mm;
            MESSAGE(std::string(is_mouse ? "mouse" : "hand"), " ", std::string(kind.name), ": ", free_mm,
                    " mm without, ", guided_mm, " mm with object following");
            if (test::is_slow()) MESSAGE(follow(scene, hand, TouchMode::proximity), " mm with proximity following");
            CHECK(free_mm > 1.0);
            CHECK(guided_mm <= 0.4 * free_mm);
            CHECK(guided_mm <= 1.05 * alone_mm[is_mouse]);
        }
    }
}

TEST_CASE("beside a tube that touches, a threshold above what lies between them follows the one as if it were alone")
{
    // Half-way both are one object, and the hand is drawn between them.
    const double alone_mm = follow(make_scene(SCENES[0], 0.75), MODELLED_HAND, TouchMode::object);
    const double parted_mm = follow(make_scene(TOUCHING, 0.75), MODELLED_HAND, TouchMode::object);
    const double joined_mm = follow(make_scene(TOUCHING, 0.25), MODELLED_HAND, TouchMode::object);
    MESSAGE("alone ", alone_mm, " mm, parted ", parted_mm, " mm, joined ", joined_mm, " mm");
    CHECK(parted_mm <= 1.05 * alone_mm);
    CHECK(joined_mm > 1.2 * alone_mm);
}

// The sense of touch from end to end, without a window or a clock: a hand follows a vessel in a noisy scan, relevance
// comes from the device's compute pass some milliseconds late, and the servo's force pulls the hand to the vessel's
// middle.

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

#include "engine/live/relevance.h"
#include "haptics/force.h"
#include "haptics/simulated_device.h"
#include "tests/support/gpu.h"
#include "tests/support/haptic_scenes.h"
#include "tests/support/nap.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr double VOXEL_MM = 0.25;
constexpr double VESSEL_RADIUS = 4.0;  ///< voxels
constexpr uint64_t TICK_NS = 1'000'000;
constexpr int MIRROR_TICKS = 12;  ///< a window queries sixty times a second or more often

/// Voxels.
constexpr WindingLine VESSEL{48.0, 14.0, 22.0, 9.0, 17.0};

/// A soft-edged vessel, brighter than its noisy surroundings; the threshold lies half-way.
TestVolume vessel(uint32_t seed)
{
    std::mt19937 random(seed);
    return volume_of({200, 96, 96}, [&](const glm::dvec3& voxel) {
        const double edge = VESSEL_RADIUS - glm::length(VESSEL.towards(voxel));
        const double inside = 1.0 / (1.0 + std::exp(-2.0 * edge));
        return 10000.0 + 30000.0 * inside + 6000.0 * (double(random()) / 4294967296.0 - 0.5);
    });
}

void publish(RelevancePatch& patch, const RelevanceBits& bits)
{
    ++patch.sequence;
    patch.time_ns = bits.asked_ns;
    patch.origin = glm::ivec3(bits.box.lower);
    patch.size = glm::ivec3(bits.box.size());
    patch.words_per_row = int32_t(bits.words_per_row);
    patch.spacing = glm::dvec3(VOXEL_MM);
    patch.volume_size = {200, 96, 96};
    std::ranges::copy(bits.words, patch.words.begin());
}

/// RMS distance of the probe from the middle line, mm. The hand moves along at 8 mm/s and drifts like a real hand.
double follow(Relevance& relevance, const HandModel& hand, bool assistance, uint32_t seed)
{
    std::mt19937 random(seed);
    const auto phase = [&] { return 2.0 * std::numbers::pi * double(random()) / 4294967296.0; };
    std::array<glm::dvec3, 3> phases;
    for (glm::dvec3& p : phases) p = {phase(), phase(), phase()};
    const auto device = std::make_unique<SimulatedDevice>(hand);
    const auto patch = std::make_unique<RelevancePatch>();
    ForceMemory memory;
    const auto growth = std::make_unique<GrowthMemory>();
    ForceSettings settings{.assistance = assistance, .probe_radius = 2.5};
    settings.workspace = {glm::dmat3(1000.0), glm::dvec3(0.0)};

    double sum = 0.0;
    int count = 0;
    DeviceState state;
    for (int tick = 0; tick < 4000; ++tick) {
        const double t = tick * 1e-3;
        const auto swing = [&](size_t which, double amplitude_mm, double hertz) {
            return std::min(t, 1.0) * amplitude_mm * glm::sin(2.0 * std::numbers::pi * hertz * t + phases[which]);
        };
        const glm::dvec3 wander = swing(0, 1.5, 0.45) + swing(1, 0.7, 1.1) + swing(2, 0.06, 9.0);
        const glm::dvec3 wish = VESSEL.at(20.0 + 8.0 / VOXEL_MM * t) * VOXEL_MM + wander;
        device->wish().publish({.position_m = wish * 1e-3, .buttons = 0, .jump = 1});
        const ReadResult result = device->read(state);
        const glm::dvec3 probe = settings.workspace.to_point(state.position_m);
        const uint64_t now_ns = uint64_t(tick + 1) * TICK_NS;
        if (tick % MIRROR_TICKS == 0) {
            // The answer queried in the last turn has arrived: relevance is 12 to 24 ticks old.
            for (int turn = 0; relevance.is_asking(); ++turn) {
                nap(turn);
                if (const auto bits = relevance.take()) publish(*patch, *bits);
            }
            relevance.ask(probe / VOXEL_MM, 25000.0, now_ns);
        }
        const ForceStep now = step(settings, device->caps(), result, state, *patch, now_ns, memory, *growth);
        device->write(now.force_n, now.sequence);
        if (tick < 1500) continue;  // engaged by then
        const glm::dvec3 away = VESSEL.towards(probe / VOXEL_MM) * VOXEL_MM;
        sum += glm::dot(away, away);
        ++count;
    }
    return std::sqrt(sum / count);
}

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "relevance is what the volume holds at or above the threshold, wherever the cube lies")
{
    load(noise_volume({100, 40, 70}, 81));
    Relevance relevance(renderer());
    for (const glm::dvec3& at :
         {glm::dvec3(50, 20, 35), glm::dvec3(-30, 5, 69), glm::dvec3(99, 39, 0), glm::dvec3(31.5)}) {
        relevance.ask(at, 30000.0, 17);
        std::optional<RelevanceBits> bits;
        for (int turn = 0; !(bits = relevance.take()); ++turn) nap(turn);
        CHECK(bits->asked_ns == 17);
        CHECK(bits->box.size() == Size3(64, 40, 64));
        CHECK(glm::all(glm::greaterThanEqual(bits->box.lower, Size3(0))));
        size_t wrong = 0;
        for (int64_t z = bits->box.lower.z; z < bits->box.upper.z; ++z)
            for (int64_t y = bits->box.lower.y; y < bits->box.upper.y; ++y)
                for (int64_t x = bits->box.lower.x; x < bits->box.upper.x; ++x) {
                    const Size3 l = Size3(x, y, z) - bits->box.lower;
                    const uint32_t word =
                        bits->words[size_t(l.x / 32 + bits->words_per_row * (l.y + bits->box.size().y * l.z))];
                    wrong += (word >> (l.x % 32) & 1u) != (volume().voxels[size_t(x + 100 * (y + 40 * z))] >= 30000.0);
                }
        CHECK(wrong == 0);
    }
    CHECK(!relevance.take());
    CHECK_THROWS_AS(relevance.ask({0.0, std::nan(""), 0.0}, 1.0, 1), Error);
}

TEST_CASE_FIXTURE(OnDevice,
                  "with assistance a hand, or a mouse, follows a vessel of a noisy scan with at most 40 % of its error")
{
    TestVolume scan = vessel(82);
    scan.spacing = glm::dvec3(VOXEL_MM);
    load(scan);
    Relevance relevance(renderer());
    for (const HandModel& hand : {MODELLED_HAND, MOUSE_HAND}) {
        const double alone_mm = follow(relevance, hand, false, 83), guided_mm = follow(relevance, hand, true, 83);
        MESSAGE(std::string(hand.mass_kg > 0.0 ? "hand" : "mouse"), ": RMS error ", alone_mm, " mm alone, ", guided_mm,
                " mm guided");
        CHECK(alone_mm > 1.0);
        CHECK(guided_mm < 0.4 * alone_mm);
    }
}

// Tools act at the middle of what is touched: traced lines lie on a tube's axis, whatever the law of the force.

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "haptics/force.h"
#include "haptics/simulated_device.h"
#include "tests/support/haptic_scenes.h"
#include "tests/support/slow.h"

using namespace shvr;

namespace {

constexpr double VOXEL_MM = 0.25, BOUND_VOXELS = 0.3;
constexpr glm::ivec3 SIZE{128, 96, 96};

double square(const glm::dvec3& v)
{
    return glm::dot(v, v);
}

/// RMS distances from the axis, voxels.
struct Traced {
    double probe = 0.0, middle = 0.0, proxy = 0.0;
};

/// A guided hand that goes along a tube at 7 mm/s and wanders as hands do.
Traced trace_along(const Rod& rod, const RelevancePatch& scene, double radius, ProxyLaw law)
{
    constexpr int ENGAGED = 1200, TICKS = 3000;
    Traced sum;
    SimulatedDevice device(MODELLED_HAND);
    const auto patch = std::make_unique<RelevancePatch>(scene);
    const auto growth = std::make_unique<GrowthMemory>();
    ForceMemory memory;
    ForceSettings settings{.assistance = true, .law = law, .probe_radius = radius, .finds_middle = true};
    settings.workspace = {glm::dmat3(1000.0 / VOXEL_MM), glm::dvec3(0.0)};
    DeviceCaps caps = device.caps();
    caps.usable_lower_m = glm::dvec3(-1.0);
    caps.usable_upper_m = glm::dvec3(1.0);
    std::mt19937 random(2);
    std::array<glm::dvec3, 3> phases;
    for (glm::dvec3& p : phases)
        for (int axis = 0; axis < 3; ++axis) p[axis] = 2.0 * std::numbers::pi * double(random()) / 4294967296.0;
    for (int tick = 0; tick < TICKS; ++tick) {
        const double t = tick * 1e-3;
        const auto swing = [&](size_t which, double amplitude, double hertz) {
            return std::min(t, 1.0) * amplitude * glm::sin(2.0 * std::numbers::pi * hertz * t + phases[which]);
        };
        const glm::dvec3 wander = (swing(0, 1.5, 0.45) + swing(1, 0.7, 1.1) + swing(2, 0.06, 9.0)) / VOXEL_MM;
        const glm::dvec3 hand = rod.point + rod.direction * (28.0 * t - 42.0) + wander;
        device.wish().publish({.position_m = hand * VOXEL_MM * 1e-3, .buttons = 0, .jump = 1});
        DeviceState state;
        device.read(state);
        patch->time_ns = uint64_t(tick + 1) * 1'000'000;
        const ForceStep now = step(settings, caps, ReadResult::fresh, state, *patch, patch->time_ns, memory, *growth);
        device.write(now.force_n, now.sequence);
        if (tick < ENGAGED) continue;
        const auto off_axis = [&](const glm::dvec3& p) {
            return square(p - rod.point - rod.direction * glm::dot(p - rod.point, rod.direction));
        };
        sum.probe += off_axis(now.probe);
        sum.middle += off_axis(now.middle);
        sum.proxy += off_axis(now.proxy);
    }
    const auto root = [](double squares) { return std::sqrt(squares / (TICKS - ENGAGED)); };
    return {root(sum.probe), root(sum.middle), root(sum.proxy)};
}

}  // namespace

// Kind (Touch): tracing at the middle of a tube, with each law of the force
TEST_CASE("a line traced at the middle of what is touched is within 0.3 voxels of the axis, with each law")
{
    const auto scene = std::make_unique<RelevancePatch>();
    std::array<double, 3> worst_middle{}, worst_proxy{};
    using List = std::vector<double>;
    for (const double tube : test::repeats(List{2.0, 4.0, 6.0}, List{2.0, 3.0, 4.0, 5.0, 6.0})) {
        const Rod rod{
            .point = {64.3, 48.2, 47.7}, .direction = glm::normalize(glm::dvec3(1.0, 0.31, 0.17)), .radius = tube};
        fill_patch(*scene, {0, 0, 0}, SIZE, glm::dvec3(1), [&](const glm::dvec3& p) { return rod.holds(p); });
        scene->volume_size = SIZE;
        const double least = std::max(6.0, 1.5 * tube);
        for (const double radius : test::repeats(List{least, 12.0}, List{least, 0.5 * (least + 12.0), 12.0})) {
            for (const ProxyLaw law : {ProxyLaw::potential, ProxyLaw::mean, ProxyLaw::thesis}) {
                CAPTURE(tube);
                CAPTURE(radius);
                CAPTURE(std::string(spelled(law)));
                const Traced traced = trace_along(rod, *scene, radius, law);
                CHECK(traced.probe > 1.0);  // the hand is not there by itself
                CHECK(traced.middle <= BOUND_VOXELS);
                worst_middle[size_t(law)] = std::max(worst_middle[size_t(law)], traced.middle);
                worst_proxy[size_t(law)] = std::max(worst_proxy[size_t(law)], traced.proxy);
            }
        }
    }
    for (const ProxyLaw law : {ProxyLaw::potential, ProxyLaw::mean, ProxyLaw::thesis}) {
        MESSAGE(std::string(spelled(law)), ": RMS at most ", worst_middle[size_t(law)], " voxels at the middle, ",
                worst_proxy[size_t(law)], " at the force's own proxy");
        CHECK(worst_proxy[size_t(law)] > BOUND_VOXELS);  // so the force's proxy is no place for tools
    }
}

TEST_CASE("a surface holds tools where it holds the probe")
{
    const auto patch = std::make_unique<RelevancePatch>();
    fill_patch(*patch, {0, 0, 0}, glm::ivec3(64), glm::dvec3(1), [](const glm::dvec3& p) { return p.z < 32.0; });
    patch->volume_size = glm::ivec3(64);
    const auto growth = std::make_unique<GrowthMemory>();
    SurfaceMemory surface;
    const ForceSettings settings{.probe_radius = 6.0, .mode = TouchMode::surface, .finds_middle = true};
    ModePull pull;
    double z = 40.0;
    for (; !pull.in_contact; z -= 0.05) {
        REQUIRE(z > 20.0);
        pull = pull_of(settings, *patch, {32, 32, z}, 1, surface, *growth);
    }
    pull = pull_of(settings, *patch, {32, 32, z - 1.0}, 2, surface, *growth);
    REQUIRE(pull.in_contact);
    CHECK(pull.middle == pull.offset);
    CHECK(pull.middle.z > 1.0);
}

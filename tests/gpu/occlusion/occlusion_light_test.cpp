// How true local ambient occlusion is: the device's light against the definition in double
// (shaders/occlusion/occlusion.h) and, where there is one, against a closed form. And that what leaping over empty
// space skips changes no bit of it.

#include <algorithm>
#include <cmath>
#include <string>

#include <doctest/doctest.h>

#include "engine/volume/procedural/source_procedural.h"
#include "tests/support/occlusion.h"
#include "tests/support/slow.h"

using namespace shvr;
using namespace shvr::test;

namespace {

using Distance = std::function<double(const glm::dvec3&)>;  ///< voxels; above 0 inside what is seen

const glm::dvec3 CENTRE(24.2, 24.4, 24.1);
constexpr double RADIUS = 16.0;

/// A case, with bounds on the mean against the closed form, the mean against the definition, and the rms against it.
struct Case {
    std::string name;
    Distance distance;
    double closed;  ///< below 0: none
    double from_closed, from_defined, rms;
    double edge = 2.0;  ///< width of the density's ramp, voxels
    double opacity = 1.0;
    bool full_sphere = false;
    double band = 0.9;             ///< voxels this near the surface are looked at
    bool lower_is_opaque = false;  ///< so are all densities below what is in the volume
};

TestVolume volume_of_case(const Case& c)
{
    return volume_of(glm::ivec3(48), [&](const glm::dvec3& voxel) {
        return std::clamp(65535.0 * (0.5 + c.distance(voxel) / c.edge), 0.0, 65535.0);
    });
}

Session session_of(const Case& c)
{
    std::vector<ControlPoint> points{{29491.0, WHITE, 0.0}, {36044.0, WHITE, c.opacity}, {65535.0, WHITE, c.opacity}};
    if (c.lower_is_opaque) {
        points[0].opacity = 1.0;
        points.insert(points.begin(), {0.0, WHITE, 1.0});
    }
    Session session = occluded(std::move(points), RADIUS);
    session.light.occlusion.full_sphere = c.full_sphere;
    return session;
}

Distance ball(double radius)
{
    return [=](const glm::dvec3& p) { return glm::length(p - CENTRE) - radius; };
}

double to_axis(const glm::dvec3& p)
{
    const glm::dvec3 axis = glm::normalize(glm::dvec3(1.0, 0.5, 0.3)), from = p - CENTRE;
    return glm::length(from - glm::dot(from, axis) * axis);
}

double to_plane(const glm::dvec3& p)
{
    return glm::dot(p - CENTRE, glm::normalize(glm::dvec3(1.0, 2.0, 3.0)));
}

/// Even noise that is smooth over `period` voxels, -1 ... 1 times `slope`.
Distance noise(double period, double slope)
{
    const auto lattice = std::make_shared<TestVolume>(noise_volume(glm::ivec3(32), 5));
    return [=](const glm::dvec3& p) { return slope * (value_at(*lattice, p / period + 3.0) / 32767.5 - 1.0); };
}

/// Mean over the wall of what a ball of this radius leaves of the light: chords.
double in_ball(double r)
{
    const double c = std::min(1.0, RADIUS / (2.0 * r));
    return r / RADIUS * c * c + 1.0 - c;
}

/// The same for a tube without ends, as the mean over many directions.
double in_tube(double r)
{
    double sum = 0.0;
    const std::vector<glm::dvec3> directions = reference::occlusion_directions(20000);
    for (const glm::dvec3& d : directions) {
        const double across = std::max(d.x * d.x + d.y * d.y, 1e-12);
        sum += std::min(1.0, 2.0 * r * std::abs(d.x) / across / RADIUS);
    }
    return sum / double(directions.size());
}

double under_ceiling(double height)
{
    return height / RADIUS * (1.0 + std::log(RADIUS / height));
}

struct Found {
    double mean = 0.0, defined = 0.0, rms = 0.0, worst = 0.0;
};

Found look_at(OnDevice& device, const Case& c)
{
    device.load(volume_of_case(c));
    const Session session = session_of(c);
    device.draw(session, overview(device.volume()));
    const std::vector<double> values = occlusion_values(device);
    const ExpectedOcclusion expected(device.volume(), session);
    Found found;
    double squares = 0.0, count = 0.0;
    std::vector<glm::ivec3> voxels;
    for (size_t i = 0; i < values.size(); ++i) {
        const glm::ivec3 voxel(int(i % 48), int(i / 48 % 48), int(i / (48 * 48)));
        const glm::dvec3 centre = glm::dvec3(voxel) + 0.5;
        if (std::abs(c.distance(centre)) < c.band && glm::length(centre - CENTRE) < 12.0) voxels.push_back(voxel);
    }
    REQUIRE(voxels.size() > 100);
    for (size_t i = 0; i < voxels.size(); i += std::max<size_t>(1, voxels.size() / 150)) {
        const glm::ivec3 voxel = voxels[i];
        const double value = values[size_t(voxel.x + 48 * (voxel.y + 48 * voxel.z))];
        const double defined = expected.defined(voxel, 256, 64);
        found.mean += value;
        found.defined += defined;
        squares += (value - defined) * (value - defined);
        found.worst = std::max(found.worst, std::abs(value - defined));
        ++count;
    }
    return {found.mean / count, found.defined / count, std::sqrt(squares / count), found.worst};
}

/// A quarter of all combinations, in which any two of the choices stand together.
bool is_in_cover(size_t scene, Sampling sampling, Paging paging, int variant)
{
    return (scene + size_t(variant)) % 2 == size_t(sampling == Sampling::hardware) &&
           (scene + size_t(variant / 2)) % 2 == size_t(paging == Paging::always);
}

}  // namespace

TEST_CASE_FIXTURE(OnDevice,
                  "light in hollows, slits, tubes, over planes and noise is the definition's, and the closed forms'")
{
    const Distance half_space = [](const glm::dvec3& p) { return -to_plane(p); };
    const auto slit = [](double width) {
        return [=](const glm::dvec3& p) { return std::abs(to_plane(p)) - 0.5 * width; };
    };
    const auto tube = [](double radius) { return [=](const glm::dvec3& p) { return to_axis(p) - radius; }; };
    const auto pipe = [](double radius, double wall) {
        return [=](const glm::dvec3& p) { return 0.5 * wall - std::abs(to_axis(p) - radius - 0.5 * wall); };
    };
    const auto sheet = [](const glm::dvec3& p) { return 0.5 - std::abs(to_plane(p)); };
    const auto wall_on_floor = [&](const glm::dvec3& p) {
        const glm::dvec3 across = glm::normalize(glm::dvec3(2.0, -1.0, 0.0));
        return std::max(-to_plane(p), 0.5 - std::abs(glm::dot(p - CENTRE, across) - 6.0));
    };
    const auto uneven = [](const glm::dvec3& p) { return 0.8 + 0.004 * std::sin(p.x / 3.0 + p.y / 5.0); };
    const auto light_in = [](double opacity) {
        const double optical = -std::log1p(-opacity) * RADIUS;
        return -std::expm1(-optical) / optical;
    };
    const std::vector<Case> cases{
        {"hollow, radius 4", ball(4.0), in_ball(4.0), 0.03, 0.02, 0.02},
        {"hollow, radius 6", ball(6.0), in_ball(6.0), 0.03, 0.015, 0.015},
        {"hollow, radius 10", ball(10.0), in_ball(10.0), 0.03, 0.02, 0.02},
        {"hollow, radius 6, hard", ball(6.0), in_ball(6.0), 0.03, 0.02, 0.02, 1.0},
        {"slit of 2", slit(2.0), under_ceiling(2.0), 0.031, 0.02, 0.02},
        {"slit of 4", slit(4.0), under_ceiling(4.0), 0.03, 0.02, 0.02},
        {"slit of 8", slit(8.0), under_ceiling(8.0), 0.03, 0.02, 0.02},
        {"half-space", half_space, 1.0, 0.03, 0.02, 0.018},
        {"half-space, translucent", half_space, 1.0, 0.03, 0.02, 0.02, 2.0, 0.3},
        {"half-space, soft", half_space, 1.0, 0.03, 0.02, 0.02, 4.0},
        {"half-space, full sphere", half_space, 0.5, 0.03, 0.02, 0.018, 2.0, 1.0, true},
        {"half-space of an axis, full sphere", [](const glm::dvec3& p) { return 24.3 - p.z; }, 0.5, 0.03, 0.02, 0.011,
         2.0, 1.0, true},
        {"lumen, radius 3", tube(3.0), in_tube(3.0), 0.03, 0.02, 0.02},
        {"lumen, radius 6", tube(6.0), in_tube(6.0), 0.03, 0.02, 0.02},
        {"rod, radius 5", [](const glm::dvec3& p) { return 5.0 - to_axis(p); }, 1.0, 0.03, 0.02, 0.018},
        {"thin sheet", sheet, -1.0, 1, 0.02, 0.02},
        {"pipe, radius 4, wall 2", pipe(4.0, 2.0), -1.0, 1, 0.02, 0.02},
        {"noise of 3 voxels", noise(3.0, 4.0), -1.0, 1, 0.02, 0.02},
        {"noise of 5 voxels", noise(5.0, 6.0), -1.0, 1, 0.02, 0.02},
        {"noise of 8 voxels", noise(8.0, 10.0), -1.0, 1, 0.02, 0.02},
        {"noise of 5 voxels, translucent", noise(5.0, 6.0), -1.0, 1, 0.02, 0.02, 2.0, 0.27},
        {"sheet on a floor", wall_on_floor, -1.0, 1, 0.02, 0.026, 2.0, 1.0, false, 0.4},
        {"even medium", [](const glm::dvec3&) { return 0.89; }, light_in(0.3), 0.01, 0.01, 0.01, 2.0, 0.3},
        {"even medium, thin, densities uneven", uneven, light_in(0.004), 0.001, 0.001, 0.001, 2.0, 0.004, false, 0.9,
         true},
    };
    for (const Case& c : cases) {
        CAPTURE(c.name);
        const Found found = look_at(*this, c);
        INFO("closed " << c.closed << ", defined " << found.defined << ", found " << found.mean);
        if (c.closed >= 0.0) check_below("closed form", std::abs(found.defined - c.closed), c.from_closed);
        check_below("mean", std::abs(found.mean - found.defined), c.from_defined);
        check_below("rms", found.rms, c.rms);
    }
}

TEST_CASE_FIXTURE(OnDevice, "leaping over empty space changes no bit of a picture with ambient occlusion")
{
    // Noise of a few voxels of which 600 reach what shows: many more are a step away from showing.
    const TestVolume white = noise_volume(glm::ivec3(49), 11);
    const TestVolume rough =
        volume_of(glm::ivec3(48), [&](const glm::dvec3& voxel) { return std::floor(value_at(white, voxel + 0.5)); });
    std::vector<double> sorted = rough.voxels;
    std::ranges::sort(sorted);
    const double shown = sorted[sorted.size() - 600];
    TestVolume tubes{.size = glm::ivec3(64)};
    std::vector<std::byte> bytes(size_t{64} * 64 * 64);
    open_procedural({.kind = "tubes", .size = Size3(64), .seed = 3})->read({Size3(0), Size3(64)}, bytes);
    for (const std::byte voxel : bytes) tubes.voxels.push_back(257.0 * std::to_integer<int>(voxel));
    struct Scene {
        const TestVolume& volume;
        std::vector<ControlPoint> points;
    };
    const Scene scenes[] = {
        {rough, {{shown, RED, 0.0}, {shown + 300.0, RED, 0.9}, {65535.0, GREEN, 0.9}}},
        {tubes, {{257.0 * 60, RED, 0.0}, {257.0 * 65, RED, 0.9}, {257.0 * 255, GREEN, 1.0}}},
        {tubes, {{257.0 * 200, RED, 0.0}, {257.0 * 204, RED, 0.9}, {257.0 * 255, GREEN, 1.0}}},
    };
    size_t lit = 0;
    for (size_t i = 0; i < std::size(scenes); ++i)
        for (const Sampling sampling : {Sampling::exact, Sampling::hardware})
            for (const Paging paging : {Paging::never, Paging::always})
                for (int variant = 0; variant < 4; ++variant) {
                    if (!is_slow() && !is_in_cover(i, sampling, paging, variant)) continue;
                    CAPTURE(i);
                    CAPTURE(variant);
                    CAPTURE(int(sampling));
                    CAPTURE(int(paging));
                    Session session = occluded(scenes[i].points, 9.0, {120, 90});
                    session.render.paging = paging;
                    session.render.detail = 0.0;
                    session.render.sampling = sampling;
                    if (variant > 0) session.light.occlusion.rays = variant == 1 ? 1 : 8;
                    if (variant > 0) session.light.gradient_fade = 0.0;
                    session.render.preintegration = variant == 3;
                    VolumeStatistics statistics = measure(*source_of(scenes[i].volume));
                    statistics.minimum = scenes[i].volume.minimum;
                    statistics.maximum = scenes[i].volume.maximum;
                    renderer().load(source_of(scenes[i].volume), statistics, session.render, true);
                    const Camera camera = overview(scenes[i].volume);
                    session.render.skip_empty_space = false;
                    const Picture all = renderer().render(session, camera);
                    session.render.skip_empty_space = true;
                    renderer().scene().occlusion().clear();
                    const Picture leaping = renderer().render(session, camera);
                    CHECK(all.complete);
                    // The device's filter rounds by where in the atlas a brick is, and bricks come in any order.
                    if (sampling == Sampling::hardware && paging == Paging::always)
                        check_below("filtered", worst_difference(pixels_of(all.image), pixels_of(leaping.image)), 1e-3);
                    else
                        CHECK(different_bits(all.image, leaping.image) == 0);
                    session.light.occlusion.strength = 0.0;
                    lit += different_bits(all.image, renderer().render(session, camera).image);
                }
    CHECK(lit > repeats<size_t>(5000, 30000));
}

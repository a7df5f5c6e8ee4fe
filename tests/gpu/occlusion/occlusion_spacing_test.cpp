// Ambient light where voxels are longer along one axis: values on the device against the definition in double, and what
// pictures show of an open plane, on which all light arrives. tests/gpu/occlusion/occlusion_light_test.cpp has the
// scenes with cubes.

#include <algorithm>
#include <cmath>
#include <string>

#include <doctest/doctest.h>

#include "tests/support/occlusion.h"
#include "tests/support/slow.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Units; above 0 inside what is seen.
using Distance = std::function<double(const glm::dvec3&)>;

const glm::dvec3 CENTRE(24.2, 24.4, 24.1);
constexpr double SIDE = 48.0, RADIUS = 16.0, NEAR_CENTRE = 12.0;

struct Case {
    std::string name;
    Distance distance;
    double rms;          ///< bound of the error against the definition
    double shown = 0.0;  ///< bound of the darkness that a picture shows; 0: not an open plane
};

glm::dvec3 normal_at(const Distance& distance, const glm::dvec3& p)
{
    constexpr double APART = 0.01;
    glm::dvec3 slope(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 step(0.0);
        step[axis] = APART;
        slope[axis] = distance(p + step) - distance(p - step);
    }
    return slope / std::max(glm::length(slope), 1e-9);
}

/// Densities rise over two voxels, however long these are in that direction.
TestVolume volume_of_case(const Case& c, const glm::dvec3& spacing)
{
    TestVolume volume = volume_of(glm::ivec3(glm::ceil(SIDE / spacing)), [&](const glm::dvec3& voxel) {
        const glm::dvec3 p = voxel * spacing;
        const double wide = 2.0 * glm::length(normal_at(c.distance, p) * spacing);
        return std::clamp(65535.0 * (0.5 + c.distance(p) / wide), 0.0, 65535.0);
    });
    volume.spacing = spacing;
    return volume;
}

/// Values between voxels, as pictures show them.
double shown_at(const std::vector<double>& values, const glm::ivec3& size, const glm::dvec3& position)
{
    const glm::dvec3 corner = glm::floor(position - 0.5), share = position - 0.5 - corner;
    double sum = 0.0;
    for (int i = 0; i < 8; ++i) {
        const glm::ivec3 offset(i & 1, i >> 1 & 1, i >> 2);
        const glm::ivec3 voxel = glm::clamp(glm::ivec3(corner) + offset, glm::ivec3(0), size - 1);
        const glm::dvec3 weight = glm::mix(1.0 - share, share, glm::dvec3(offset));
        sum += weight.x * weight.y * weight.z * values[size_t(voxel.x + size.x * (voxel.y + size.y * voxel.z))];
    }
    return sum;
}

/// The voxels that a sample of the surface may read.
std::vector<glm::ivec3> voxels_of_surface(const Case& c, const glm::ivec3& size, const glm::dvec3& spacing)
{
    std::vector<glm::ivec3> voxels;
    for (int i = 0; i < size.x * size.y * size.z; ++i) {
        const glm::ivec3 voxel(i % size.x, i / size.x % size.y, i / (size.x * size.y));
        const glm::dvec3 p = (glm::dvec3(voxel) + 0.5) * spacing;
        const double voxel_length = glm::length(normal_at(c.distance, p) * spacing);
        if (std::abs(c.distance(p)) < 0.9 * voxel_length && glm::length(p - CENTRE) < NEAR_CENTRE)
            voxels.push_back(voxel);
    }
    return voxels;
}

void check_case(OnDevice& device, const Case& c, const glm::dvec3& spacing)
{
    device.load(volume_of_case(c, spacing));
    const Session session = occluded({{29491.0, WHITE, 0.0}, {36044.0, WHITE, 1.0}, {65535.0, WHITE, 1.0}}, RADIUS);
    device.draw(session, overview(device.volume()));
    const std::vector<double> values = occlusion_values(device);
    const ExpectedOcclusion expected(device.volume(), session);
    const glm::ivec3 size = device.volume().size;
    const std::vector<glm::ivec3> voxels = voxels_of_surface(c, size, spacing);
    REQUIRE(voxels.size() > 50);
    double squares = 0.0, count = 0.0, darkest = 0.0;
    for (size_t i = 0; i < voxels.size(); i += std::max<size_t>(1, voxels.size() / 120)) {
        const glm::ivec3& voxel = voxels[i];
        const double value = values[size_t(voxel.x + size.x * (voxel.y + size.y * voxel.z))];
        const double error = value - expected.defined(voxel, 256, 64);
        squares += error * error;
        ++count;
        const glm::dvec3 p = (glm::dvec3(voxel) + 0.5) * spacing;
        const glm::dvec3 on_surface = p - c.distance(p) * normal_at(c.distance, p);
        darkest = std::max(darkest, 1.0 - shown_at(values, size, on_surface / spacing));
    }
    check_below("rms", std::sqrt(squares / count), c.rms);
    if (c.shown > 0.0) check_below("darkness of an open plane", darkest, c.shown);
}

Distance plane(const glm::dvec3& normal)
{
    return [n = glm::normalize(normal)](const glm::dvec3& p) { return -glm::dot(p - CENTRE, n); };
}

/// Walls that rise at 45 degrees, along y.
double groove(const glm::dvec3& p)
{
    constexpr double DEPTH = 6.0;
    return std::sqrt(0.5) * (std::abs(p.x - CENTRE.x) - (p.z - CENTRE.z) - DEPTH);
}

double lumen(const glm::dvec3& p)
{
    const glm::dvec3 axis = glm::normalize(glm::dvec3(1.0, 0.5, 0.3)), from = p - CENTRE;
    return glm::length(from - glm::dot(from, axis) * axis) - 6.0;
}

}  // namespace

// Kind (Light): ambient occlusion with anisotropic spacing
TEST_CASE_FIXTURE(OnDevice, "light is the definition's, and all of it on planes, however long voxels are along an axis")
{
    const auto hollow = [](const glm::dvec3& p) { return glm::length(p - CENTRE) - 10.0; };
    const auto slit = [](const glm::dvec3& p) {
        return std::abs(glm::dot(p - CENTRE, glm::normalize(glm::dvec3(1.0, 2.0, 3.0)))) - 6.0;
    };
    const std::vector<Case> cases{{"plane across z", plane({0.0, 0.0, 1.0}), 0.003, 0.003},
                                  {"plane across -z", plane({0.0, 0.0, -1.0}), 0.003, 0.003},
                                  {"plane across x", plane({1.0, 0.0, 0.0}), 0.003, 0.003},
                                  {"oblique plane", plane({1.0, 2.0, 3.0}), 0.022, 0.055},
                                  {"steep plane", plane({3.0, 1.0, 1.0}), 0.02, 0.045},
                                  {"flat plane", plane({1.0, 0.0, 3.0}), 0.025, 0.065},
                                  {"hollow, radius 10", hollow, 0.03},
                                  {"oblique slit of 12", slit, 0.025},
                                  {"groove", groove, 0.02},
                                  {"lumen, radius 6", lumen, 0.035}};
    const std::vector<glm::dvec3> spacings =
        is_slow() ? std::vector<glm::dvec3>{{1, 1, 1.5}, {1, 1, 2}, {1, 1, 3}, {1, 1, 5}, {4, 1, 2}}
                  : std::vector<glm::dvec3>{{1, 1, 1.5}, {1, 1, 5}};
    for (const glm::dvec3& spacing : spacings)
        for (const Case& c : cases) {
            CAPTURE(c.name);
            CAPTURE(spacing.x);
            CAPTURE(spacing.z);
            check_case(*this, c, spacing);
        }
}

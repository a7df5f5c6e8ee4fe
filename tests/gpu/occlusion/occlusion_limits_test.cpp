// How far local ambient occlusion is from its definition where eight samples a ray do not resolve the medium: walls of
// one voxel, white noise, and radii far from 16. tests/STABILITY.md lists the errors, shaders/MEASURED.md what was
// tried against them.

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include <doctest/doctest.h>

#include "tests/support/occlusion.h"
#include "tests/support/slow.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr double LOWER = 29491.0, UPPER = 36044.0;          ///< densities of opacity 0 and 1
using Distance = std::function<double(const glm::dvec3&)>;  ///< from the middle, voxels; above 0 inside what is seen

/// A medium whose density rises over two voxels at its surface, or white noise, and the bound on the rms error.
struct Limit {
    std::string name;
    Distance distance;  ///< null: white noise, seen from `lower` on
    double radius, rms;
    double band = 0.9;  ///< voxels this near the surface are looked at
    double lower = LOWER;
};

double to_axis(const glm::dvec3& p)
{
    const glm::dvec3 axis = glm::normalize(glm::dvec3(1.0, 0.5, 0.3));
    return glm::length(p - glm::dot(p, axis) * axis);
}

double to_plane(const glm::dvec3& p)
{
    return glm::dot(p, glm::normalize(glm::dvec3(1.0, 2.0, 3.0)));
}

Distance pipe(double radius, double wall)
{
    return [=](const glm::dvec3& p) { return 0.5 * wall - std::abs(to_axis(p) - radius - 0.5 * wall); };
}

/// A sheet of one voxel, upright on a floor, looked at where both are near.
Distance sheet_on_floor(double away)
{
    return [=](const glm::dvec3& p) {
        const glm::dvec3 across = glm::normalize(glm::dvec3(2.0, -1.0, 0.0));
        return std::max(-to_plane(p), 0.5 - std::abs(glm::dot(p, across) - away));
    };
}

/// Even noise that is smooth over `period` voxels.
Distance noise(double period)
{
    const auto lattice = std::make_shared<TestVolume>(noise_volume(glm::ivec3(32), 5));
    return [=](const glm::dvec3& p) {
        return 1.2 * period * (value_at(*lattice, (p + 24.0) / period + 3.0) / 32767.5 - 1.0);
    };
}

/// The rms error over voxels that are seen, within 12 voxels of the middle.
double error_of(OnDevice& device, const Limit& limit)
{
    const int side = limit.radius > 20.0 ? 96 : 48;
    const glm::dvec3 middle = glm::dvec3(side / 2) + glm::dvec3(0.2, 0.4, 0.1);
    device.load(limit.distance ? volume_of(glm::ivec3(side),
                                           [&](const glm::dvec3& voxel) {
                                               return std::clamp(65535.0 * (0.5 + limit.distance(voxel - middle) / 2.0),
                                                                 0.0, 65535.0);
                                           })
                               : noise_volume(glm::ivec3(side), 7));
    const double upper = limit.lower + (UPPER - LOWER);
    const Session session =
        occluded({{limit.lower, WHITE, 0.0}, {upper, WHITE, 1.0}, {65535.0, WHITE, 1.0}}, limit.radius);
    device.draw(session, overview(device.volume()));
    const std::vector<double> values = occlusion_values(device);
    const ExpectedOcclusion expected(device.volume(), session);
    std::vector<size_t> seen;
    for (size_t i = 0; i < values.size(); ++i) {
        const glm::dvec3 from = glm::dvec3(int(i) % side, int(i) / side % side, int(i) / (side * side)) + 0.5 - middle;
        const bool is_near =
            limit.distance ? std::abs(limit.distance(from)) < limit.band : device.volume().voxels[i] > limit.lower;
        if (is_near && glm::length(from) < 12.0) seen.push_back(i);
    }
    REQUIRE(seen.size() > 100);
    const size_t apart = std::max<size_t>(1, seen.size() / repeats<size_t>(40, 150));
    double squares = 0.0, count = 0.0;
    for (size_t k = 0; k < seen.size(); k += apart) {
        const int i = int(seen[k]);
        const glm::ivec3 voxel(i % side, i / side % side, i / (side * side));
        const int steps = std::max(64, int(3.0 * limit.radius));
        const double error = values[seen[k]] - expected.defined(voxel, 256, steps);
        squares += error * error;
        ++count;
    }
    return std::sqrt(squares / count);
}

}  // namespace

// Kind (Light): ambient occlusion of walls of one voxel, of white noise, and at radii of 1 to 50 voxels
TEST_CASE_FIXTURE(OnDevice, "where samples do not resolve the medium, ambient light errs as is stated")
{
    const std::vector<Limit> limits{
        {"pipe, radius 4, wall of 1", pipe(4.0, 1.0), 16.0, 0.1},
        {"sheet of 1, 4 voxels away", sheet_on_floor(4.0), 16.0, 0.043, 0.4},
        {"sheet of 1, 9 voxels away", sheet_on_floor(9.0), 16.0, 0.035, 0.4},
        {"white noise, half opaque", {}, 16.0, 0.038},
        {"white noise, a fifth opaque", {}, 16.0, 0.16, 0.9, 52000.0},
        {"noise of 3 voxels, radius 1", noise(3.0), 1.0, 0.05},
        {"noise of 3 voxels, radius 2", noise(3.0), 2.0, 0.033},
        {"noise of 3 voxels, radius 4", noise(3.0), 4.0, 0.036},
        {"white noise, radius 1", {}, 1.0, 0.32},
        {"noise of 5 voxels, radius 28", noise(5.0), 28.0, 0.034},
        {"noise of 5 voxels, radius 50", noise(5.0), 50.0, 0.05},
        {"white noise, radius 50", {}, 50.0, 0.036},
    };
    for (const Limit& limit : limits) {
        CAPTURE(limit.name);
        check_below("rms, " + limit.name, error_of(*this, limit), limit.rms);
    }
}

// Corners of what cutting planes leave.

#include "engine/look/cut_corners.h"

#include <algorithm>
#include <random>

#include <doctest/doctest.h>

using namespace shvr;

namespace {

VolumeInfo volume()
{
    VolumeInfo info;
    info.size = {20, 16, 12};
    info.spacing = {1.0, 0.5, 2.0};
    return info;
}

}  // namespace

TEST_CASE("what a cut leaves reaches as far along any direction as its corners do")
{
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const auto direction = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
    const glm::dvec3 size(volume().size);
    for (int i = 0; i < 50; ++i) {
        CAPTURE(i);
        CutBox cut;
        if (i % 2) cut = {{2.0, 0.0, 3.5}, {17.25, 1e6, 11.0}};
        cut.plane_normal = direction();
        cut.plane_point = (0.5 + 0.4 * direction()) * size;
        const std::vector<glm::dvec3> corners = corners_left(cut, volume());
        const glm::dvec3 lower = glm::max(cut.lower, glm::dvec3(0.0)), upper = glm::min(cut.upper, size);
        const auto is_left = [&](const glm::dvec3& voxel, double room) {
            return glm::all(glm::greaterThanEqual(voxel, lower - room)) &&
                   glm::all(glm::lessThanEqual(voxel, upper + room)) &&
                   glm::dot(*cut.plane_normal, (voxel - *cut.plane_point) * volume().spacing) <= room;
        };
        for (const glm::dvec3& corner : corners) CHECK(is_left(corner, 1e-9));
        const glm::dvec3 along = direction();
        double most = -1e300, sampled = -1e300;
        for (const glm::dvec3& corner : corners) most = std::max(most, glm::dot(corner, along));
        for (int sample = 0; sample < 4000; ++sample) {
            const glm::dvec3 voxel = glm::mix(lower, upper, 0.5 * (direction() + 1.0));
            if (is_left(voxel, 0.0)) sampled = std::max(sampled, glm::dot(voxel, along));
        }
        CHECK(sampled <= most + 1e-9);
        CHECK(most - sampled < 0.25 * glm::length(size));  // and no farther
    }
}

TEST_CASE("without an oblique plane the corners are those of the box, and a plane may leave nothing")
{
    CutBox cut{{2.0, 3.0, 4.0}, {1e6, 9.0, 10.0}};
    CHECK(corners_left(cut, volume()).size() == 8);
    CHECK(box_left(cut, volume()) == std::pair(glm::dvec3(2.0, 3.0, 4.0), glm::dvec3(20.0, 9.0, 10.0)));
    cut.plane_normal = glm::dvec3(0.0, 0.0, 3.0);
    cut.plane_point = glm::dvec3(0.0, 0.0, 7.0);
    CHECK(box_left(cut, volume()) == std::pair(glm::dvec3(2.0, 3.0, 4.0), glm::dvec3(20.0, 9.0, 7.0)));
    cut.plane_point->z = 3.5;
    CHECK(corners_left(cut, volume()).empty());
    CHECK(!box_left(cut, volume()));
    CHECK(corners_left(CutBox{{5.0, 0.0, 0.0}, {4.0, 9.0, 9.0}}, volume()).empty());
}

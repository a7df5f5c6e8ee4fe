#include <doctest/doctest.h>

#include "engine/look/surfaces/corner_normals.h"

using namespace shvr;

namespace {

/// A box whose triangles share its 8 corners.
MeshShape box()
{
    MeshShape mesh;
    for (int i = 0; i < 8; ++i) mesh.points.push_back({i & 1, i >> 1 & 1, i >> 2});
    for (const glm::uvec4& side : {glm::uvec4(0, 2, 3, 1), glm::uvec4(4, 5, 7, 6), glm::uvec4(0, 1, 5, 4),
                                   glm::uvec4(2, 6, 7, 3), glm::uvec4(0, 4, 6, 2), glm::uvec4(1, 3, 7, 5)}) {
        mesh.triangles.push_back({side.x, side.y, side.z});
        mesh.triangles.push_back({side.x, side.z, side.w});
    }
    return mesh;
}

/// A strip of two rectangles along z that meet at an angle.
MeshShape fold(double degrees)
{
    const double angle = glm::radians(degrees);
    MeshShape mesh;
    for (const double z : {0.0, 1.0})
        for (const glm::dvec2& at : {glm::dvec2(-1, 0), glm::dvec2(0, 0), glm::dvec2(cos(angle), sin(angle))})
            mesh.points.push_back({at, z});
    mesh.triangles = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
    return mesh;
}

}  // namespace

TEST_CASE("the sides of a box are flat, although they share its corners")
{
    const MeshShape mesh = box();
    const CornerNormals normals(mesh);
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto at = [&](int i) { return mesh.points[mesh.triangles[t][i]]; };
        const glm::dvec3 own = glm::normalize(glm::cross(at(1) - at(0), at(2) - at(0)));
        for (int corner = 0; corner < 3; ++corner) CHECK(glm::distance(normals.at(t, corner), own) < 1e-12);
    }
}

TEST_CASE("normals are joined over edges of up to 30 degrees")
{
    for (const double degrees : {10.0, 29.0, 31.0, 90.0}) {
        CAPTURE(degrees);
        const MeshShape mesh = fold(degrees);
        const CornerNormals normals(mesh);
        const double turned = degrees > 30.0 ? 0.0 : glm::radians(0.5 * degrees);
        // The two triangles of the corner at (0, 0, 0) on the left and right take up 90 degrees each.
        const glm::dvec3 left = normals.at(0, 1), right = normals.at(2, 0);
        CHECK(glm::distance(left, right) < (degrees > 30.0 ? 2.0 : 1e-7));
        CHECK(std::acos(std::min(1.0, glm::dot(left, normals.at(0, 0)))) == doctest::Approx(turned).epsilon(1e-6));
    }
}

TEST_CASE("triangles without area have no normal, and points of many triangles one for all")
{
    MeshShape mesh = box();
    mesh.triangles.push_back({0, 0, 1});
    CHECK_FALSE(CornerNormals(mesh).has_area(12));
    CHECK(CornerNormals(mesh).has_area(11));
    MeshShape tent;
    tent.points.push_back({0, 0, 1});
    constexpr uint32_t SIDES = 200'000;  // work by their square would not end
    for (uint32_t i = 0; i < SIDES; ++i) {
        const double angle = glm::radians(360.0 * i / SIDES);
        tent.points.push_back({std::cos(angle), std::sin(angle), 0.0});
        tent.triangles.push_back({0, 1 + i, 1 + (i + 1) % SIDES});
    }
    const CornerNormals normals(tent);
    double farthest = 0.0;
    for (size_t t = 0; t < SIDES; ++t)
        farthest = std::max(farthest, glm::distance(normals.at(t, 0), glm::dvec3(0, 0, 1)));
    CHECK(farthest < 1e-6);
}

#include "engine/annotation/trace/local_radius.h"

#include <algorithm>

#include <doctest/doctest.h>

#include "tests/support/slow.h"

using namespace shvr;

namespace {

/// Voxels of a straight tube through the middle of a box; its edge falls from 200 to 0 within a voxel, so that 100 is
/// where it ends.
DensityBox tube(const glm::dvec3& along, double radius, const glm::dvec3& spacing)
{
    DensityBox box{.lower = {7, -3, 11}, .size = {48, 48, 48}};
    const glm::dvec3 axis = glm::normalize(along);
    for (int z = 0; z < box.size.z; ++z)
        for (int y = 0; y < box.size.y; ++y)
            for (int x = 0; x < box.size.x; ++x) {
                const glm::dvec3 from_middle = (glm::dvec3(x, y, z) + 0.5 - 24.0) * spacing;
                const double away = glm::length(from_middle - glm::dot(from_middle, axis) * axis);
                box.values.push_back(200.0 * std::clamp(0.5 + radius - away, 0.0, 1.0));
            }
    return box;
}

/// How far the ball's middle is from the tube's axis.
double beside_axis(const LocalBall& ball, const DensityBox& box, const glm::dvec3& along)
{
    const glm::dvec3 axis = glm::normalize(along), away = ball.middle - glm::dvec3(box.lower) - 24.0;
    return glm::length(away - glm::dot(away, axis) * axis);
}

/// Every day a third of all combinations, in which any two values of two factors meet: places in the lists of values
/// whose sum is a multiple of three. `counts`: lengths of the lists, that of the innermost loop first.
bool is_tried(int number, std::initializer_list<int> counts)
{
    int sum = 0;
    for (const int count : counts) sum += number % count, number /= count;
    return test::is_slow() || sum % 3 == 0;
}

}  // namespace

TEST_CASE("A tube's radius is measured from its density, beside its axis, too")
{
    double worst = 0.0, worst_middle = 0.0;
    int number = 0;
    for (const double radius : {2.0, 3.0, 5.0, 8.0})
        for (const glm::dvec3& along : {glm::dvec3(0, 0, 1), glm::dvec3(1, 1, 0), glm::dvec3(1, 2, 3)}) {
            const DensityBox box = tube(along, radius, glm::dvec3(1.0));
            for (const double beside : {0.0, 0.3, 0.6}) {
                if (!is_tried(number++, {3, 3, 4})) continue;
                const glm::dvec3 across = glm::normalize(glm::cross(along, glm::dvec3(0.3, 1.0, -0.2)));
                const glm::dvec3 voxel = glm::dvec3(box.lower) + 24.0 + beside * radius * across;
                const auto found =
                    local_ball([&](const glm::dvec3& at) { return box.at(at); }, 100.0, voxel, glm::dvec3(1.0), 20.0);
                CAPTURE(radius);
                CAPTURE(beside);
                REQUIRE(found.has_value());
                CHECK(std::abs(found->radius - radius) < 0.15);
                CHECK(beside_axis(*found, box, along) < 0.3);
                worst = std::max(worst, std::abs(found->radius - radius));
                worst_middle = std::max(worst_middle, beside_axis(*found, box, along));
            }
        }
    MESSAGE("largest errors: of the radius ", worst, ", of the middle ", worst_middle, " voxels");
}

TEST_CASE("A tube's radius is physical where voxels are not cubes")
{
    const glm::dvec3 spacing(1.0, 1.0, 0.5);
    const DensityBox box = tube({1.0, 0.0, 0.0}, 4.0, spacing);
    const auto found = local_ball([&](const glm::dvec3& at) { return box.at(at); }, 100.0, glm::dvec3(box.lower) + 24.0,
                                  spacing, 10.0);
    REQUIRE(found.has_value());
    CHECK(std::abs(found->radius - 4.0) < 0.15);
}

TEST_CASE("No radius is measured outside a structure, nor in one that goes on")
{
    const DensityBox box = tube({0.0, 0.0, 1.0}, 3.0, glm::dvec3(1.0));
    const auto density_at = [&](const glm::dvec3& at) { return box.at(at); };
    CHECK(!local_ball(density_at, 100.0, glm::dvec3(box.lower) + glm::dvec3(30.0, 24.0, 24.0), glm::dvec3(1.0), 20.0));
    CHECK(!local_ball(density_at, 100.0, glm::dvec3(box.lower) + 24.0, glm::dvec3(1.0), 2.5));
    CHECK(!local_ball([](const glm::dvec3&) { return 1.0; }, 0.5, {3.0, 4.0, 5.0}, glm::dvec3(1.0), 8.0));
}

TEST_CASE("What is seen on a tube's wall, from any side, has its middle on the axis")
{
    double worst = 0.0;
    int number = 0;
    for (const double radius : {2.0, 4.0, 8.0})
        for (const glm::dvec3& along : {glm::dvec3(0, 0, 1), glm::dvec3(1, 2, 3)}) {
            const DensityBox box = tube(along, radius, glm::dvec3(1.0));
            for (const double slant : {0.0, 0.6, 1.2})         // of the line of sight, along the tube
                for (const double beside : {0.0, 0.5, 0.8}) {  // of the axis, in radii
                    if (!is_tried(number++, {3, 3, 2, 3})) continue;
                    const auto density_at = [&](const glm::dvec3& at) { return box.at(at); };
                    const glm::dvec3 axis = glm::normalize(along);
                    const glm::dvec3 across = glm::normalize(glm::cross(axis, glm::dvec3(0.3, 1.0, -0.2)));
                    const glm::dvec3 towards = glm::cross(axis, across);
                    const double depth = std::sqrt(1.0 - beside * beside) * radius;
                    const glm::dvec3 voxel = glm::dvec3(box.lower) + 24.0 + beside * radius * across - depth * towards;
                    CAPTURE(radius);
                    CAPTURE(slant);
                    CAPTURE(beside);
                    const auto found =
                        ball_behind(density_at, 100.0, voxel, 3.0 * (towards + slant * axis), glm::dvec3(1.0), 20.0);
                    REQUIRE(found.has_value());
                    CHECK(beside_axis(*found, box, along) < 0.3);
                    worst = std::max(worst, beside_axis(*found, box, along));
                    // In the other direction there is nothing except the wall itself.
                    CHECK(!ball_behind(density_at, 100.0, voxel - 4.0 * towards, -towards, glm::dvec3(1.0), 20.0));
                }
        }
    MESSAGE("largest error: ", worst, " voxels");
    const DensityBox wall = tube({0.0, 0.0, 1.0}, 40.0, glm::dvec3(1.0));
    CHECK(!ball_behind([&](const glm::dvec3& at) { return wall.at(at); }, 100.0, glm::dvec3(wall.lower) + 24.0,
                       {1.0, 0.0, 0.0}, glm::dvec3(1.0), 10.0));
}

TEST_CASE("A density box interpolates linearly between the middles of voxels, and holds its border")
{
    const DensityBox box{.lower = {2, 0, 0}, .size = {2, 1, 1}, .values = {10.0, 30.0}};
    CHECK(box.at({2.5, 0.5, 0.5}) == 10.0);
    CHECK(box.at({3.0, 0.2, 0.9}) == 20.0);
    CHECK(box.at({9.0, 0.5, 0.5}) == 30.0);
    CHECK(box.at({-9.0, 0.5, 0.5}) == 10.0);
}

TEST_CASE("A click on something wide stays near its line of sight, and says that the middle lies elsewhere")
{
    DensityBox ball{.lower = {0, 0, 0}, .size = {64, 64, 64}};
    const glm::dvec3 middle(32.0), towards(0.0, 0.0, 1.0);
    const double radius = 20.0;
    for (int z = 0; z < 64; ++z)
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 64; ++x)
                ball.values.push_back(
                    200.0 * std::clamp(0.5 + radius - glm::distance(glm::dvec3(x, y, z) + 0.5, middle), 0.0, 1.0));
    const auto density_at = [&](const glm::dvec3& at) { return ball.at(at); };
    const auto clicked = [&](double beside, double aside) {
        const glm::dvec3 voxel = middle + glm::dvec3(beside, 0.0, -std::sqrt(radius * radius - beside * beside));
        return ball_behind(density_at, 100.0, voxel, towards, glm::dvec3(1.0), 24.0, aside);
    };
    const auto held = clicked(15.0, 4.0);
    REQUIRE(held.has_value());
    CHECK(held->is_held);
    CHECK(std::abs(held->middle.x - 47.0) < 4.01);  // where the click was
    CHECK(std::abs(held->middle.x - 43.0) < 0.3);   // as near to the middle as it may go
    CHECK(std::abs(held->radius - 9.0) < 0.3);
    const auto near = clicked(3.0, 4.0), free = clicked(15.0, 24.0);
    REQUIRE(near.has_value());
    REQUIRE(free.has_value());
    CHECK(!near->is_held);
    CHECK(!free->is_held);
    CHECK(glm::distance(near->middle, middle) < 0.5);
    CHECK(glm::distance(free->middle, middle) < 0.5);
}

#include <random>

#include <doctest/doctest.h>

#include "engine/look/camera.h"
#include "engine/passes/raycast.h"

using namespace shvr;

namespace {

/// Whether the line from `a` to `b` meets the box; in voxels.
bool meets(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& lower, const glm::dvec3& upper)
{
    double begin = 0.0, end = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        const double from = (lower[axis] - a[axis]) / (b[axis] - a[axis]);
        const double to = (upper[axis] - a[axis]) / (b[axis] - a[axis]);
        begin = std::max(begin, std::min(from, to));
        end = std::min(end, std::max(from, to));
    }
    return begin < end;
}

}  // namespace

TEST_CASE("no ray outside the pixels of an iso-surface meets its region, and they are few where it is small")
{
    std::mt19937 random(9);
    const auto in = [&](double lower, double upper) {
        return std::uniform_real_distribution<double>(lower, upper)(random);
    };
    constexpr uint32_t SIDE = 96;
    int narrow = 0, whole = 0, unseen = 0;
    for (int trial = 0; trial < 300; ++trial) {
        CAPTURE(trial);
        VolumeInfo info;
        info.size = Size3(40, 60, 50);
        info.spacing = glm::dvec3(in(0.5, 2.0), in(0.5, 2.0), in(0.5, 4.0));
        Camera camera;
        camera.projection = trial % 3 == 0 ? Camera::Projection::orthographic : Camera::Projection::perspective;
        const glm::dvec3 extent = glm::dvec3(info.size) * info.spacing;
        camera.eye = extent * glm::dvec3(in(-1.5, 2.5), in(-1.5, 2.5), in(-1.5, 2.5));
        camera.target = extent * glm::dvec3(in(0.2, 0.8), in(0.2, 0.8), in(0.2, 0.8));
        camera.up = {0.1, 0.2, 1.0};
        camera.height = glm::length(extent);
        const RayPlanes planes = ray_planes(camera, {SIDE, SIDE}, info);
        if (planes.empty) continue;
        gpu::RaycastParams params{};
        params.near_corner = planes.near_corner, params.near_dx = planes.near_dx, params.near_dy = planes.near_dy;
        params.far_corner = planes.far_corner, params.far_dx = planes.far_dx, params.far_dy = planes.far_dy;
        params.pixel_begin = {uint32_t(in(0, 20)), uint32_t(in(0, 20))};
        params.pixel_end = {SIDE - uint32_t(in(0, 20)), SIDE - uint32_t(in(0, 20))};
        params.shell_center = glm::dvec3(info.size) * glm::dvec3(in(-0.2, 1.2), in(-0.2, 1.2), in(-0.2, 1.2));
        params.shell_reach = glm::vec3(float(in(1.0, 9.0))) / glm::vec3(info.spacing);
        const ShellPixels found = shell_pixels(params);
        const glm::uvec2 size = params.pixel_end - params.pixel_begin;
        CHECK(glm::all(glm::lessThanEqual(found.end, size)));
        int outside = 0;
        for (uint32_t y = 0; y < size.y; ++y)
            for (uint32_t x = 0; x < size.x; ++x) {
                const bool is_inside = x >= found.begin.x && x < found.end.x && y >= found.begin.y && y < found.end.y;
                if (is_inside) continue;
                const glm::dvec2 at = glm::dvec2(params.pixel_begin + glm::uvec2(x, y)) + 0.5;
                const auto on = [&](const glm::vec3& corner, const glm::vec3& dx, const glm::vec3& dy) {
                    return glm::dvec3(corner) + at.x * glm::dvec3(dx) + at.y * glm::dvec3(dy);
                };
                outside += meets(on(params.near_corner, params.near_dx, params.near_dy),
                                 on(params.far_corner, params.far_dx, params.far_dy),
                                 glm::dvec3(params.shell_center) - glm::dvec3(params.shell_reach),
                                 glm::dvec3(params.shell_center) + glm::dvec3(params.shell_reach));
            }
        CHECK(outside == 0);
        const glm::uvec2 covered = glm::max(found.end, found.begin) - found.begin;
        unseen += covered.x == 0 || covered.y == 0;
        narrow += covered.x * covered.y > 0 && 2 * covered.x * covered.y < size.x * size.y;
        whole += covered == size;
    }
    CHECK(narrow > 50);
    CHECK(whole > 5);
    CHECK(unseen > 5);
}

TEST_CASE("where numbers are none an iso-surface may be in every pixel")
{
    gpu::RaycastParams params{};  // planes without extent
    params.pixel_end = {30, 20};
    const ShellPixels found = shell_pixels(params);
    CHECK(found.begin == glm::uvec2(0));
    CHECK(found.end == glm::uvec2(30, 20));
}

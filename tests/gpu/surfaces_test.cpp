// Opaque balls and rods: where rays meet them, compared with distances in double.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include <doctest/doctest.h>

#include "shaders/counters.h"
#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// The signed distance of a point from a surface, and its gradient. A rod is the union of all balls between its two
/// ends; the nearest of these is found with the slope of the tangent cone.
struct Distance {
    double value = 1e300;
    glm::dvec3 normal{0.0};
};
Distance distance_from(const SurfaceLook& surface, const glm::dvec3& point)
{
    const glm::dvec3 along = surface.to - surface.from;
    const double length = glm::length(along), difference = surface.radius_from - surface.radius_to;
    double share = length > std::abs(difference) ? 0.0 : difference < 0.0 ? 1.0 : 0.0;
    if (length > std::abs(difference)) {
        const glm::dvec3 axis = along / length;
        const double x = glm::dot(point - surface.from, axis), sine = difference / length;
        const double y = glm::length(point - surface.from - x * axis);
        share = std::clamp((x - y * sine / std::sqrt(1.0 - sine * sine)) / length, 0.0, 1.0);
    }
    const glm::dvec3 from_center = point - (surface.from + share * along);
    const double away = glm::length(from_center);
    return {away - (surface.radius_from - share * difference), away > 0.0 ? from_center / away : glm::dvec3(0.0)};
}

struct Ray {
    glm::dvec3 origin, direction;  // volume space; of unit length
    double begin, end;             // lengths of the clip range
    glm::dvec3 at(double s) const { return origin + s * direction; }
};

/// Where a ray enters a surface with radii larger by `grown`; infinity if it does not. Distance from a convex body is a
/// convex function along a line, and changes by no more than the way along it.
double entry(const SurfaceLook& surface, const Ray& ray, double grown)
{
    const auto distance = [&](double s) { return distance_from(surface, ray.at(s)).value - grown; };
    const double middle = glm::dot(0.5 * (surface.from + surface.to) - ray.origin, ray.direction);
    const double reach =
        glm::distance(surface.from, surface.to) + surface.radius_from + surface.radius_to + grown + 1.0;
    double low = std::max(middle - reach, ray.begin), high = std::min(middle + reach, ray.end);
    if (!(low < high)) return INFINITY;
    const double begin = low;
    for (int i = 0; i < 120 && high - low > 1e-12 * reach; ++i) {
        const double third = (high - low) / 3.0, a = low + third, b = high - third;
        const double at_a = distance(a), at_b = distance(b);
        if (std::min(at_a, at_b) > third) return INFINITY;  // no place is farther than a third from both
        (at_a < at_b ? high : low) = at_a < at_b ? b : a;
    }
    double inside = 0.5 * (low + high), outside = begin;
    if (distance(inside) > 0.0) return INFINITY;
    if (distance(outside) <= 0.0) return outside;
    for (int i = 0; i < 80; ++i) {
        const double s = 0.5 * (inside + outside);
        if (s == inside || s == outside) break;
        (distance(s) <= 0.0 ? inside : outside) = s;
    }
    return inside;
}

struct Sight {
    std::vector<Ray> rays;
    std::vector<glm::vec4> seen;  // as the pass stores them
};

class Surfaces : public OnDevice {
public:
    VolumeInfo info;
    glm::uvec2 pixels{24, 24};
    glm::vec3 light{0.0f, 0.0f, 1.0f};
    size_t max_in_leaf = gpu::SURFACES_IN_LEAF;
    PixelGroups groups{.tile = {128, 128}};
    uint32_t nodes_in_dispatch = NODES_IN_DISPATCH, max_rounds = UINT32_MAX;
    uint64_t rays_cut_short = 0;  // of all looks

    Surfaces() { info.size = Size3(100); }

    /// Runs the pass alone: white light from `light`, diffuse only.
    Sight look(const std::vector<SurfaceLook>& surfaces, const Camera& camera)
    {
        const RayPlanes planes = ray_planes(camera, pixels, info);
        SurfaceScene scene(renderer().memory());
        scene.set(SurfaceForest(keyed(surfaces), info, max_in_leaf));
        FrameGraph graph;
        SurfacesInput input{.params = {},
                            .scene = scene.params(planes, pixels, info),
                            .listed = scene.upload(graph),
                            .pixel_groups = groups,
                            .nodes_in_dispatch = nodes_in_dispatch,
                            .max_rounds = max_rounds};
        input.params.pixel_end = pixels;
        input.params.light = light;
        input.params.diffuse = 1.0f;
        input.params.inverse_spacing = glm::vec3(1.0f);
        const uint32_t index = graph.read_back(shvr::surfaces(graph, input));
        const gpu::FrameResult result = renderer().executor().run(std::move(graph));
        for (const gpu::PassReport& pass : result.passes)
            if (pass.name == "surfaces") rays_cut_short += pass.counters.at(gpu::COUNTER_CUT_SHORT);
        Sight sight{{}, std::vector<glm::vec4>(size_t(pixels.x) * pixels.y)};
        std::memcpy(sight.seen.data(), result.read_backs[index].data(), sight.seen.size() * sizeof(glm::vec4));
        for (uint32_t y = 0; y < pixels.y; ++y)
            for (uint32_t x = 0; x < pixels.x; ++x) {
                const glm::dvec2 at(x + 0.5, y + 0.5);
                const glm::dvec3 near = planes.near_corner + at.x * planes.near_dx + at.y * planes.near_dy;
                const glm::dvec3 far = planes.far_corner + at.x * planes.far_dx + at.y * planes.far_dy;
                const double length = glm::distance(near * info.spacing, far * info.spacing);
                sight.rays.push_back({near * info.spacing, (far - near) * info.spacing / length, planes.begin * length,
                                      planes.end * length});
            }
        return sight;
    }

    struct Errors {
        size_t hits = 0;
        size_t wrong = 0;          ///< pixels that show a wrong surface, or wrongly none
        double shade = 0.0;        ///< largest error of the diffuse light
        double min_length = 1e30;  ///< shortest length along a ray
    };
    /// A length must lie between those at which the ray enters surfaces larger and smaller by `off`.
    Errors check(const std::vector<SurfaceLook>& surfaces, const Camera& camera, double off, double length_off = 0.0)
    {
        const Sight sight = look(surfaces, camera);
        Errors errors;
        for (size_t i = 0; i < sight.rays.size(); ++i) {
            const Ray& ray = sight.rays[i];
            double earliest = INFINITY, latest = INFINITY;
            for (const SurfaceLook& surface : surfaces) {
                earliest = std::min(earliest, entry(surface, ray, off));
                latest = std::min(latest, entry(surface, ray, -off));
            }
            const double length = sight.seen[i].a < gpu::NO_SURFACE ? double(sight.seen[i].a) : INFINITY;
            errors.wrong += length < earliest - length_off || length > latest + length_off;
            if (length == INFINITY) continue;
            ++errors.hits;
            errors.min_length = std::min(errors.min_length, length);
            if (length <= ray.begin + off) continue;  // cut by the near plane
            Distance nearest, second;
            for (const SurfaceLook& surface : surfaces) {
                const Distance distance = distance_from(surface, ray.at(length));
                if (distance.value < nearest.value)
                    second = nearest, nearest = distance;
                else if (distance.value < second.value)
                    second = distance;
            }
            if (second.value < 4.0 * off && glm::distance(second.normal, nearest.normal) > 1e-3) continue;  // a seam
            const double expected = std::max(glm::dot(nearest.normal, glm::dvec3(light)), 0.0);
            errors.shade = std::max(errors.shade, std::abs(expected - double(sight.seen[i].r)));
        }
        return errors;
    }
};

struct Dice {
    std::mt19937 random;
    double operator()(double low, double high) { return low + (high - low) * double(random()) / 4294967296.0; }
    glm::dvec3 point(double low, double high) { return {(*this)(low, high), (*this)(low, high), (*this)(low, high)}; }
};

std::vector<SurfaceLook> random_rods(size_t count, uint32_t seed, double longest, double thickest)
{
    Dice dice{std::mt19937(seed)};
    std::vector<SurfaceLook> rods(count);
    for (SurfaceLook& rod : rods) {
        rod.from = dice.point(10.0, 90.0);
        rod.to = rod.from + dice.point(-longest, longest);
        rod.radius_from = dice(0.02 * thickest, thickest);
        rod.radius_to = dice(0.02 * thickest, thickest);
        if (dice(0.0, 1.0) < 0.2) rod.to = rod.from, rod.radius_to = rod.radius_from;
    }
    return rods;
}

Camera orthographic(const glm::dvec3& target, const glm::dvec3& direction, double height)
{
    Camera camera = perspective(target - 200.0 * glm::normalize(direction), target, 30.0);
    camera.projection = Camera::Projection::orthographic;
    camera.height = height;
    return camera;
}

SurfaceLook ball(const glm::dvec3& center, double radius)
{
    return {center, center, radius, radius};
}

const glm::dvec3 MIDDLE(50.0);

}  // namespace

TEST_CASE_FIXTURE(Surfaces, "rods and balls are met where their distance is 0, and lit along its gradient")
{
    light = glm::normalize(glm::vec3(-0.3f, 0.5f, -0.8f));
    size_t hits = 0;
    for (const auto& [longest, thickest] : {std::pair(20.0, 5.0), {60.0, 1.0}, {3.0, 12.0}}) {
        CAPTURE(longest);
        const std::vector<SurfaceLook> rods = random_rods(40, 91, longest, thickest);  // seed 91
        for (const glm::dvec3& direction : {glm::dvec3(1, 2, 3), glm::dvec3(-1, 0, 0), glm::dvec3(0.1, -0.2, 1)}) {
            for (const Camera& camera :
                 {orthographic(MIDDLE, direction, 120.0), perspective(MIDDLE - 90.0 * direction, MIDDLE, 40.0)}) {
                const Errors errors = check(rods, camera, 1e-4);
                CHECK(errors.wrong == 0);
                check_below("shade", errors.shade, 2e-3);
                hits += errors.hits;
            }
        }
    }
    CHECK(hits > 2000);
}

TEST_CASE_FIXTURE(Surfaces,
                  "a ray that passes a surface by a hair misses it, and one that touches it by a hair does not")
{
    pixels = {1, 1};
    const SurfaceLook shapes[] = {ball({50, 50, 50}, 3.0),
                                  {{50, 20, 50}, {50, 80, 50}, 3.0, 3.0},
                                  {{50, 50, 50}, {50, 90, 50}, 3.0, 0.5},
                                  {{50, 50, 50}, {90, 50, 50}, 3.0, 1.0}};
    for (const SurfaceLook& shape : shapes) {
        // The silhouette against x, seen along x: found by bisection on the reference alone.
        double inside = 50.0, outside = 60.0;
        const auto ray_at = [](double z) { return Ray{{-100.0, 50.0, z}, {1.0, 0.0, 0.0}, 0.0, 1000.0}; };
        for (int i = 0; i < 60; ++i) {
            const double z = 0.5 * (inside + outside);
            (entry(shape, ray_at(z), 0.0) < INFINITY ? inside : outside) = z;
        }
        for (const double away : {-1e-2, -1e-3, -1e-4, -2e-5, 2e-5, 1e-4, 1e-3, 1e-2}) {
            CAPTURE(away);
            const Camera camera = orthographic({50.0, 50.0, inside + away}, {1, 0, 0}, 1.0);
            CHECK((look({shape}, camera).seen[0].a < gpu::NO_SURFACE) == (away < 0.0));
        }
    }
}

TEST_CASE_FIXTURE(Surfaces, "rays along a rod, and along the slope of one, end at it")
{
    pixels = {9, 9};
    const std::vector<SurfaceLook> rods{{{50, 50, 20}, {50, 50, 80}, 4.0, 4.0}};
    CHECK(check(rods, orthographic(MIDDLE, {0, 0, 1}, 9.0), 1e-4).wrong == 0);
    CHECK(check(rods, orthographic(MIDDLE, {0, 1e-6, -1}, 9.0), 1e-4).wrong == 0);
    const std::vector<SurfaceLook> cones{{{50, 50, 20}, {50, 50, 80}, 31.0, 1.0}};  // a slope of 30 degrees
    const double cosine = std::sqrt(0.75);
    CHECK(check(cones, orthographic(MIDDLE, {0.0, 0.5, -cosine}, 40.0), 1e-4).wrong == 0);
    CHECK(check(cones, orthographic(MIDDLE, {0.0, 0.5, cosine}, 40.0), 1e-4).wrong == 0);
}

TEST_CASE_FIXTURE(Surfaces, "one ball in the other is the larger one")
{
    const std::vector<SurfaceLook> one{{{50, 50, 50}, {52, 51, 50}, 9.0, 3.0}},
        other{{{52, 51, 50}, {50, 50, 50}, 3.0, 9.0}};
    const Camera camera = orthographic(MIDDLE, {1, 2, 3}, 30.0);
    const Sight ball_alone = look({ball({50, 50, 50}, 9.0)}, camera);
    CHECK((look(one, camera).seen == ball_alone.seen));
    CHECK((look(other, camera).seen == ball_alone.seen));
}

TEST_CASE_FIXTURE(Surfaces, "an eye in a surface sees it at once, facing the eye")
{
    light = {1.0f, 0.0f, 0.0f};
    for (const SurfaceLook& shape : {ball(MIDDLE, 8.0), SurfaceLook{{40, 50, 50}, {60, 52, 50}, 7.0, 4.0}}) {
        const Camera camera = perspective(MIDDLE, {40.0, 50.0, 50.0}, 60.0);  // towards -x, so that facing it is +x
        const Sight sight = look({shape}, camera);
        size_t wrong = 0;
        for (size_t i = 0; i < sight.seen.size(); ++i) {
            wrong += std::abs(double(sight.seen[i].a) - sight.rays[i].begin) > 1e-5;
            wrong += std::abs(double(sight.seen[i].r) + sight.rays[i].direction.x) > 1e-5;
        }
        CHECK(wrong == 0);
        CHECK(check({shape}, perspective({50.0, 50.0, 61.0}, MIDDLE, 60.0), 1e-4).wrong == 0);  // from just outside
    }
}

TEST_CASE_FIXTURE(Surfaces, "clip planes cut surfaces, and show them filled")
{
    const std::vector<SurfaceLook> shapes{ball({50, 50, 50}, 20.0), ball({50, 50, -400.0}, 30.0)};
    Camera camera = orthographic(MIDDLE, {0, 0, 1}, 80.0);  // the eye is at z = -150
    light = {0.0f, 0.0f, -1.0f};
    const Errors whole = check(shapes, camera, 1e-4);
    CHECK(whole.wrong == 0);  // objects behind the eye are not visible
    camera.near_distance = 195.0;
    const Sight cut = look(shapes, camera);
    CHECK(double(cut.seen[12 + 24 * 12].a) == doctest::Approx(cut.rays[0].begin).epsilon(1e-6));
    CHECK(cut.seen[12 + 24 * 12].r == doctest::Approx(1.0));
    CHECK(check(shapes, camera, 1e-4).hits == whole.hits);
    camera.far_distance = 190.0;
    camera.near_distance = 0.0;
    const Errors shortened = check(shapes, camera, 1e-4);
    CHECK(shortened.wrong == 0);
    CHECK((shortened.hits > 0 && shortened.hits < whole.hits));
    // The clip range may exclude the whole volume: from z = 180 on, in front of it and behind it.
    const std::vector<SurfaceLook> outside{ball({50, 50, 400}, 20.0)};
    camera.near_distance = 400.0;
    camera.far_distance = 0.0;
    CHECK(ray_planes(camera, pixels, info).empty);
    const Errors behind = check(outside, camera, 1e-4);
    CHECK(behind.wrong == 0);
    CHECK(behind.hits > 20);
    camera.far_distance = 500.0;
    CHECK(check(outside, camera, 1e-4).hits == 0);
}

TEST_CASE_FIXTURE(Surfaces, "a far eye loses nothing")
{
    const std::vector<SurfaceLook> rods = random_rods(30, 92, 20.0, 4.0);  // seed 92
    for (const double distance : {1e3, 1e5, 1e7, 1e9}) {
        CAPTURE(distance);
        Camera camera = perspective(MIDDLE - distance * glm::normalize(glm::dvec3(1, 2, 3)), MIDDLE,
                                    glm::degrees(2.0 * std::atan(60.0 / distance)));
        CHECK(check(rods, camera, 1e-4).wrong == 0);
        camera.projection = Camera::Projection::orthographic;
        camera.height = 120.0;
        const Errors errors = check(rods, camera, 1e-4);
        CHECK(errors.wrong == 0);
        CHECK(errors.hits > 50);
    }
}

TEST_CASE_FIXTURE(Surfaces, "65536 voxels from the origin a surface is a thousandth of a voxel off at most")
{
    // Lengths along a ray are floats, with a last digit of 2^-7 at that distance; positions across the ray are exact.
    info.size = Size3(65536);
    const glm::dvec3 corner(65480.3, 65391.7, 65102.9);
    std::vector<SurfaceLook> rods = random_rods(30, 93, 20.0, 4.0);  // seed 93
    for (SurfaceLook& rod : rods) rod.from += corner - MIDDLE, rod.to += corner - MIDDLE;
    for (const glm::dvec3& direction : {glm::dvec3(1, 2, 3), glm::dvec3(0, 0, -1), glm::dvec3(-3, 0.2, 1)}) {
        const Errors parallel = check(rods, orthographic(corner, direction, 60.0), 1e-3, 0.01);
        CHECK(parallel.wrong == 0);
        CHECK(parallel.hits > 100);
        check_below("shade", parallel.shade, 0.02);
        CHECK(check(rods, perspective(corner - 90.0 * glm::normalize(direction), corner, 40.0), 1e-3, 1e-3).wrong == 0);
        CHECK(check(rods, perspective(corner - 3e4 * glm::normalize(direction), corner, 0.1), 1e-3, 0.01).wrong == 0);
    }
}

TEST_CASE_FIXTURE(Surfaces, "the hierarchy finds what asking every surface finds, bit for bit")
{
    std::vector<SurfaceLook> rods = random_rods(1500, 94, 15.0, 3.0);  // seed 94
    Dice dice{std::mt19937(95)};
    for (SurfaceLook& rod : rods) rod.color = dice.point(0.1, 1.0);
    for (size_t i = 0; i < 300; ++i) {  // the same place twice, in another colour: the first one is visible
        rods.push_back(rods[i]);
        rods.back().color = dice.point(0.1, 1.0);
    }
    pixels = {67, 53};
    size_t hits = 0;
    for (const Camera& camera :
         {orthographic(MIDDLE, {1, 2, 3}, 120.0), orthographic(MIDDLE, {0, 1, 0}, 120.0),
          perspective(MIDDLE, {10.0, 50.0, 70.0}, 90.0), perspective({-1e6, 50, 50}, MIDDLE, 0.01)}) {
        max_in_leaf = gpu::SURFACES_IN_LEAF;
        const Sight found = look(rods, camera);
        max_in_leaf = rods.size();
        const Sight asked = look(rods, camera);
        CHECK((found.seen == asked.seen));
        for (const glm::vec4& pixel : asked.seen) hits += pixel.a < gpu::NO_SURFACE;
        std::vector<SurfaceLook> first(rods.begin(), rods.begin() + 1500);
        CHECK((look(first, camera).seen == asked.seen));
    }
    CHECK(hits > 5000);
}

TEST_CASE_FIXTURE(Surfaces, "rays find the same in their tile's list and, where it is full, among the boxes")
{
    const std::vector<SurfaceLook> rods = random_rods(gpu::SURFACES_IN_TILE, 96, 30.0, 3.0);  // seed 96
    pixels = {67, 53};
    size_t hits = 0, misses = 0;
    for (const Camera& camera : {orthographic(MIDDLE, {1, 2, 3}, 120.0), orthographic(MIDDLE, {0, 1, 0}, 0.7),
                                 orthographic(rods[0].from + glm::dvec3(0, 0, rods[0].radius_from), {0, 1, 0}, 1e-4),
                                 perspective(MIDDLE, {10.0, 50.0, 70.0}, 90.0),
                                 perspective({-1e6, 50, 50}, MIDDLE, 0.01), perspective({50, 50, -70}, MIDDLE, 40.0)}) {
        const Sight listed = look(rods, camera);
        // One that all rays meet behind the others, as often as fills every list.
        const glm::dvec3 ahead = glm::normalize(camera.target - camera.eye);
        std::vector<SurfaceLook> crowded = rods;
        crowded.resize(2 * rods.size() + 1, ball(MIDDLE + 5000.0 * ahead, 4800.0));
        const Sight searched = look(crowded, camera);
        for (size_t i = 0; i < listed.seen.size(); ++i) {
            if (listed.seen[i].a < gpu::NO_SURFACE) {
                ++hits;
                CHECK((searched.seen[i] == listed.seen[i]));
            } else {
                ++misses;
                CHECK((searched.seen[i].a > 100.0f));
            }
        }
    }
    CHECK(hits > 2000);
    CHECK(misses > 2000);
}

TEST_CASE_FIXTURE(Surfaces, "nodes may be looked at in several dispatches, by rays with lists and by those without")
{
    std::vector<SurfaceLook> rods = random_rods(400, 98, 30.0, 3.0);  // seed 98
    pixels = {67, 53};
    for (const double height : {120.0, 2.0}) {
        const Camera camera = orthographic(MIDDLE, {1, 2, 3}, height);
        for (const bool is_crowded : {false, true}) {
            if (is_crowded) rods.resize(rods.size() + gpu::SURFACES_IN_TILE + 1, ball({500, 1000, 1500}, 1700.0));
            nodes_in_dispatch = NODES_IN_DISPATCH;
            const std::vector<glm::vec4> seen = look(rods, camera).seen;
            for (const uint32_t nodes : {1u, 7u, 100u}) {
                CAPTURE(nodes);
                nodes_in_dispatch = nodes;
                CHECK((look(rods, camera).seen == seen));
            }
        }
        rods.resize(400);
    }
}

TEST_CASE_FIXTURE(Surfaces, "no device ends the loops of a dispatch before its nodes")
{
    std::vector<SurfaceLook> balls;  // that all rays meet, nearer and nearer
    Dice dice{std::mt19937(99)};
    const size_t count = 2 * NODES_IN_DISPATCH;
    for (size_t i = 0; i < count; ++i) balls.push_back(ball(dice.point(49.0, 51.0), 30.0 + 0.001 * double(i)));
    pixels = {8, 8};
    for (const glm::dvec3& direction : {glm::dvec3(1, 2, 3), glm::dvec3(-1, -2, -3), glm::dvec3(0, 1, 0)}) {
        const Camera camera = orthographic(MIDDLE, direction, 1.0);
        nodes_in_dispatch = NODES_IN_DISPATCH;
        const Sight at_once = look(balls, camera);
        nodes_in_dispatch = 500;
        CHECK((look(balls, camera).seen == at_once.seen));
        CHECK(rays_cut_short == 0);
    }
}

TEST_CASE_FIXTURE(Surfaces, "however workgroups share the pixels of a picture, all are drawn with the same bits")
{
    const std::vector<SurfaceLook> rods = random_rods(300, 97, 30.0, 3.0);  // seed 97
    const Camera camera = perspective({50, 50, -70}, MIDDLE, 60.0);
    for (const glm::uvec2& size : {glm::uvec2(1, 1), glm::uvec2(3, 70), glm::uvec2(131, 197)}) {
        pixels = size;
        groups = {};
        const std::vector<glm::vec4> seen = look(rods, camera).seen;
        for (const uint32_t width : {8u, 16u, 32u})
            for (const uint32_t layers : {1u, 2u, 3u, 8u, 64u})
                for (const uint32_t tile : {0u, 64u, 128u}) {
                    groups = {};
                    look({ball(camera.eye, 1.0)}, camera);  // else what is not drawn may be of the picture before
                    groups = {.width = width, .layers = layers, .tile = glm::uvec2(tile)};
                    CAPTURE(width);
                    CAPTURE(layers);
                    CAPTURE(tile);
                    CHECK((look(rods, camera).seen == seen));
                }
    }
}

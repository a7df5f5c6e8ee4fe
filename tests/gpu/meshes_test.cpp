// Triangles of meshes: where rays meet them, compared with double precision; no ray passes between triangles that share
// an edge; meshes, trace and probe hide each other by depth.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <random>

#include <doctest/doctest.h>

#include "shaders/counters.h"
#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

MeshShape shape_of(std::vector<glm::dvec3> points, std::vector<glm::uvec3> triangles, const glm::dvec3& color)
{
    const auto end = uint32_t(triangles.size());
    return {"mesh", std::move(points), std::move(triangles), {color}, {end}};
}

/// A sphere of 8 * 4^steps triangles, from an octahedron.
MeshShape sphere(const glm::dvec3& center, double radius, int steps, const glm::dvec3& color = glm::dvec3(1.0))
{
    std::vector<glm::dvec3> points{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    std::vector<glm::uvec3> triangles{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                      {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    for (int step = 0; step < steps; ++step) {
        std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
        const auto middle = [&](uint32_t a, uint32_t b) {
            const auto [found, is_new] = middles.insert({std::minmax(a, b), uint32_t(points.size())});
            if (is_new) points.push_back(glm::normalize(points[a] + points[b]));
            return found->second;
        };
        std::vector<glm::uvec3> finer;
        for (const glm::uvec3& t : triangles) {
            const uint32_t ab = middle(t.x, t.y), bc = middle(t.y, t.z), ca = middle(t.z, t.x);
            for (const glm::uvec3& each :
                 {glm::uvec3(t.x, ab, ca), glm::uvec3(ab, t.y, bc), glm::uvec3(ca, bc, t.z), glm::uvec3(ab, bc, ca)})
                finer.push_back(each);
        }
        triangles = std::move(finer);
    }
    for (glm::dvec3& point : points) point = center + radius * point;
    return shape_of(std::move(points), std::move(triangles), color);
}

/// A square of 2 n^2 triangles across z, with corners at whole numbers.
MeshShape sheet(int n, double z)
{
    std::vector<glm::dvec3> points;
    std::vector<glm::uvec3> triangles;
    for (int y = 0; y <= n; ++y)
        for (int x = 0; x <= n; ++x) points.push_back({double(x), double(y), z});
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const auto a = uint32_t(x + (n + 1) * y), b = a + 1, c = a + uint32_t(n) + 1, d = c + 1;
            triangles.push_back({a, b, d});
            triangles.push_back({a, d, c});
        }
    return shape_of(std::move(points), std::move(triangles), glm::dvec3(1.0));
}

struct Ray {
    glm::dvec3 origin, direction;  ///< volume space; of unit length
};

/// Length along a ray to the nearest triangle, in double (Moeller and Trumbore 1997); corners as the device has them.
double reference(const MeshShape& mesh, const Ray& ray)
{
    double nearest = INFINITY;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a(glm::vec3(mesh.points[t.x])), b(glm::vec3(mesh.points[t.y])), c(glm::vec3(mesh.points[t.z]));
        const glm::dvec3 across = glm::cross(ray.direction, c - a), from = ray.origin - a;
        const double determinant = glm::dot(b - a, across);
        if (determinant == 0.0) continue;
        const double u = glm::dot(from, across) / determinant;
        const glm::dvec3 other = glm::cross(from, b - a);
        const double v = glm::dot(ray.direction, other) / determinant;
        const double at = glm::dot(c - a, other) / determinant;
        if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && at >= 0.0) nearest = std::min(nearest, at);
    }
    return nearest;
}

struct Sight {
    std::vector<Ray> rays;
    std::vector<glm::vec4> seen;  ///< as the pass stores them
};

class Meshes : public OnDevice {
public:
    VolumeInfo info;
    glm::uvec2 pixels{40, 32};
    glm::vec3 light{0.0f, 0.0f, -1.0f};
    uint32_t nodes_in_dispatch = NODES_IN_DISPATCH, max_rounds = UINT32_MAX;
    uint64_t rays_cut_short = 0;

    Meshes() { info.size = Size3(100); }

    /// Runs the pass alone: white light, diffuse only.
    Sight look(const std::vector<MeshShape>& meshes, const Camera& camera)
    {
        const RayPlanes planes = ray_planes(camera, pixels, info);
        MeshScene scene(renderer().memory());
        scene.set(mesh_tree(meshes, info));
        FrameGraph graph;
        SurfacesInput input{.params = {},
                            .scene = scene.params(planes, pixels, info),
                            .listed = scene.upload(graph),
                            .pixel_groups = {.tile = {128, 128}},
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
                sight.rays.push_back({near * info.spacing, glm::normalize((far - near) * info.spacing)});
            }
        return sight;
    }
};

Camera orthographic(const glm::dvec3& target, const glm::dvec3& direction, double height)
{
    Camera camera = perspective(target - 200.0 * glm::normalize(direction), target, 30.0);
    camera.projection = Camera::Projection::orthographic;
    camera.height = height;
    return camera;
}

const glm::dvec3 MIDDLE(50.0);

/// Triangles at random, of which many meet.
MeshShape soup(size_t count, uint32_t seed)
{
    std::mt19937 random(seed);
    const auto number = [&](double low, double high) { return low + (high - low) * double(random()) / 4294967296.0; };
    std::vector<glm::dvec3> points;
    std::vector<glm::uvec3> triangles;
    for (uint32_t i = 0; i < count; ++i) {
        const glm::dvec3 at(number(15, 85), number(15, 85), number(15, 85));
        for (int corner = 0; corner < 3; ++corner)
            points.push_back(at + glm::dvec3(number(-12, 12), number(-12, 12), number(-12, 12)));
        triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    return shape_of(std::move(points), std::move(triangles), glm::dvec3(1.0));
}

}  // namespace

TEST_CASE_FIXTURE(Meshes, "triangles are met where double precision meets them")
{
    const MeshShape mesh = soup(300, 17);  // seed 17
    size_t hits = 0, differing = 0;
    double error = 0.0;
    for (const glm::dvec3& direction : {glm::dvec3(1, 2, 3), glm::dvec3(-1, 0, 0), glm::dvec3(0.1, -0.2, 1)})
        for (const Camera& camera :
             {orthographic(MIDDLE, direction, 110.0), perspective(MIDDLE - 90.0 * direction, MIDDLE, 40.0)}) {
            const Sight sight = look({mesh}, camera);
            for (size_t i = 0; i < sight.rays.size(); ++i) {
                const double expected = reference(mesh, sight.rays[i]);
                const bool is_met = sight.seen[i].a < gpu::NO_SURFACE;
                if (!is_met || expected == INFINITY || std::abs(expected - sight.seen[i].a) > 1e-3 * expected) {
                    differing += is_met || expected < INFINITY;
                    continue;
                }
                ++hits;
                error = std::max(error, std::abs(expected - double(sight.seen[i].a)) / expected);
            }
        }
    CHECK(hits > 3000);
    CHECK(differing <= 3);                         // rays within rounding of an edge
    check_below("length, relative", error, 1e-5);  // largest where triangles are seen from near their edge
    CHECK(rays_cut_short == 0);
}

TEST_CASE_FIXTURE(Meshes, "no ray passes between triangles, even through corners and along edges")
{
    pixels = {48, 48};
    // Orthographic rays through whole numbers, so through corners, and halves, so through edges and diagonals.
    for (const double shift : {0.0, 0.5, 0.25}) {
        CAPTURE(shift);
        const Camera camera = orthographic({24.0 + shift, 24.0 + shift, 50.0}, {0, 0, 1}, 48.0);
        const Sight sight = look({sheet(64, 50.0)}, camera);
        size_t missed = 0;
        for (size_t i = 0; i < sight.rays.size(); ++i) {
            const glm::dvec3 at = sight.rays[i].origin;
            const bool is_inside = at.x >= 0.0 && at.y >= 0.0 && at.x <= 64.0 && at.y <= 64.0;
            missed += is_inside && !(sight.seen[i].a < gpu::NO_SURFACE);
        }
        CHECK(missed == 0);
    }
    // A sphere around the eye hides all that lies behind it, and so does one seen from far away.
    for (const double distance : {0.0, 7.0, 5000.0}) {
        CAPTURE(distance);
        for (const glm::dvec3& direction : {glm::dvec3(0, 0, 1), glm::dvec3(1, 1, 1), glm::dvec3(0.3, -0.7, 0.2)}) {
            const glm::dvec3 eye = MIDDLE - distance * glm::normalize(direction);
            const Camera camera = perspective(eye, eye + direction, distance > 100.0 ? 0.2 : 60.0);
            size_t missed = 0;
            const Sight sight = look({sphere(MIDDLE, 20.0, 4)}, camera);
            for (const glm::vec4& seen : sight.seen) missed += !(seen.a < gpu::NO_SURFACE);
            CHECK(missed == 0);
        }
    }
}

TEST_CASE_FIXTURE(Meshes, "both sides are lit, with normals between those of the corners")
{
    pixels = {32, 32};
    const Camera camera = orthographic(MIDDLE, {0, 0, 1}, 20.0);
    for (const bool is_turned : {false, true}) {
        CAPTURE(is_turned);
        MeshShape mesh = sphere(MIDDLE, 20.0, 4);
        if (is_turned)
            for (glm::uvec3& triangle : mesh.triangles) std::swap(triangle.x, triangle.y);
        const Sight sight = look({mesh}, camera);
        double error = 0.0;
        for (size_t i = 0; i < sight.rays.size(); ++i) {
            const glm::dvec3 at = sight.rays[i].origin + double(sight.seen[i].a) * sight.rays[i].direction;
            error = std::max(error, std::abs(double(sight.seen[i].r) + glm::normalize(at - MIDDLE).z));
        }
        check_below("diffuse light", error, 0.01);  // flat triangles would differ by 0.05
    }
}

TEST_CASE_FIXTURE(Meshes, "blocks of nodes make no difference")
{
    const std::vector<MeshShape> meshes{soup(300, 18), sphere(MIDDLE, 12.0, 3)};  // seed 18
    const Camera camera = perspective({-60, 20, 30}, MIDDLE, 40.0);
    const Sight whole = look(meshes, camera);
    nodes_in_dispatch = 37;
    const Sight parts = look(meshes, camera);
    CHECK(std::memcmp(whole.seen.data(), parts.seen.data(), whole.seen.size() * sizeof(glm::vec4)) == 0);
    CHECK(rays_cut_short == 0);
}

TEST_CASE_FIXTURE(OnDevice, "meshes, trace, probe and volume hide each other by depth")
{
    load(constant_volume({40, 40, 40}, 0.0));
    Session session = plain_session(uniform_points(RED, 0.0), {1, 1});
    session.light = {.shaded = false, .ambient = 1.0, .diffuse = 0.0, .specular = 0.0};
    const Camera camera = camera_along(volume(), {0, 0, 1}, 1.0);
    const auto center = [&] { return glm::dvec3(pixels_of(draw(session, camera))[0]); };
    static_cast<void>(renderer().render(session, camera));  // prepares the volume
    const Picture before = renderer().render(session, camera);
    CHECK(std::ranges::count(before.passes, "surfaces", &gpu::PassReport::name) == 0);

    const auto show = [&](double z) {
        const std::vector<MeshShape> meshes{sphere({20, 20, z}, 3.0, 2, BLUE)};
        renderer().scene().show_meshes(mesh_tree(meshes, renderer().volume().info()));
    };
    show(30.0);
    check_below("mesh", glm::distance(center(), BLUE), 1e-6);
    const glm::dvec3 ball(20, 20, 10);
    renderer().scene().set_surfaces({{ball, ball, 2.0, 2.0, GREEN}});
    check_below("ball before the mesh", glm::distance(center(), GREEN), 1e-6);
    show(4.0);
    check_below("mesh before the ball", glm::distance(center(), BLUE), 1e-6);
    renderer().scene().set_surfaces({});
    renderer().scene().show_meshes({});
    const Picture after = renderer().render(session, camera);
    CHECK(different_bits(after.image, before.image) == 0);
    CHECK(after.passes.size() == before.passes.size());
}

TEST_CASE("meshes that cannot be drawn are refused with a reason")
{
    VolumeInfo info;
    info.size = Size3(10);
    MeshShape mesh = sphere(glm::dvec3(5.0), 2.0, 0);
    mesh.points[3].x = 1e9;
    CHECK_THROWS_WITH_AS(mesh_tree(std::vector{mesh}, info), doctest::Contains("mesh: a corner is at (1e+09"), Error);
    mesh.points[3].x = NAN;
    CHECK_THROWS_AS(mesh_tree(std::vector{mesh}, info), Error);
    mesh.points[3] = mesh.points[0];  // triangles without area are left out
    CHECK(mesh_tree(std::vector{mesh}, info).list.size() == 6);
    CHECK(mesh_tree({}, info).nodes.empty());
}

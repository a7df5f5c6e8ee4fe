#include "engine/look/camera.h"

#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "tests/support/bounds.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

glm::dvec3 centre_of(const VolumeInfo& volume)
{
    return 0.5 * glm::dvec3(volume.size) * volume.spacing;
}

struct Ray {
    glm::dvec3 near_point, far_point;  ///< voxel space
};

Ray ray_at(const RayPlanes& planes, double x, double y)
{
    return {planes.near_corner + x * planes.near_dx + y * planes.near_dy,
            planes.far_corner + x * planes.far_dx + y * planes.far_dy};
}

double distance_to(const Ray& ray, const glm::dvec3& point)
{
    const glm::dvec3 direction = glm::normalize(ray.far_point - ray.near_point);
    const glm::dvec3 offset = point - ray.near_point;
    return glm::length(offset - direction * glm::dot(offset, direction));
}

using Vector = glm::vec<3, long double>;

/// Where the ray of picture position (x, y) is closest to `point` (voxel space), in long double and directly from the
/// eye; `miss` is their distance.
long double miss_of_exact_ray(const Camera& camera, const glm::uvec2& pixels, const VolumeInfo& volume, double x,
                              double y, const glm::dvec3& point)
{
    const Vector eye(camera.eye);
    const Vector forward = glm::normalize(Vector(camera.target) - eye);
    const Vector right = glm::normalize(glm::cross(forward, Vector(camera.up)));
    const Vector up = glm::cross(right, forward);
    const long double tangent =
        std::tan(0.5L * static_cast<long double>(camera.fov_y_degrees) * 3.14159265358979323846264338L / 180.0L);
    const long double pixel = 2.0L * tangent / pixels.y;
    const Vector direction = forward + right * (pixel * (static_cast<long double>(x) - 0.5L * pixels.x)) -
                             up * (pixel * (static_cast<long double>(y) - 0.5L * pixels.y));
    const Vector along = glm::normalize(direction / Vector(volume.spacing));
    const Vector offset = Vector(point) - eye / Vector(volume.spacing);
    return glm::length(offset - along * glm::dot(offset, along));
}

}  // namespace

TEST_CASE("the ray of a point's projection passes through the point")
{
    const VolumeInfo volume = volume_of_size({40, 60, 50}, {1.0, 0.5, 2.0});
    Camera camera;
    camera.eye = {-70.0, -90.0, 130.0};
    camera.target = {18.0, 20.0, 45.0};
    camera.up = {0.1, 0.2, 1.0};
    camera.fov_y_degrees = 47.0;
    const glm::uvec2 pixels(320, 200);
    const glm::dvec3 forward = glm::normalize(camera.target - camera.eye);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, camera.up));
    const glm::dvec3 up = glm::cross(right, forward);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    for (const bool is_perspective : {true, false}) {
        camera.projection = is_perspective ? Camera::Projection::perspective : Camera::Projection::orthographic;
        camera.height = 150.0;
        const RayPlanes planes = ray_planes(camera, pixels, volume);
        REQUIRE_FALSE(planes.empty);
        for (int round = 0; round < 200; ++round) {
            const glm::dvec3 voxel = glm::dvec3(share(random), share(random), share(random)) * glm::dvec3(volume.size);
            const glm::dvec3 offset = voxel * volume.spacing - camera.eye;
            const double half_height =
                is_perspective ? glm::dot(offset, forward) * std::tan(47.0 * 3.14159265358979323846 / 360.0) : 75.0;
            const double x = 160.0 + 100.0 * glm::dot(offset, right) / half_height;
            const double y = 100.0 - 100.0 * glm::dot(offset, up) / half_height;
            const Ray ray = ray_at(planes, x, y);
            CHECK(distance_to(ray, voxel) < 1e-9);
            // The point lies between the planes.
            const double share_of_ray = glm::dot(voxel - ray.near_point, ray.far_point - ray.near_point) /
                                        glm::dot(ray.far_point - ray.near_point, ray.far_point - ray.near_point);
            CHECK(share_of_ray >= 0.0);
            CHECK(share_of_ray <= 1.0);
        }
    }
}

TEST_CASE("the ray through the middle of the picture hits the target")
{
    const VolumeInfo volume = volume_of_size({64, 64, 64}, {1.0, 1.0, 20.0});
    for (const std::string& side : camera_sides()) {
        Camera camera = camera_looking(side, volume);
        camera.target += glm::dvec3(3.0, -5.0, 7.0);
        for (const Camera::Projection projection :
             {Camera::Projection::perspective, Camera::Projection::orthographic}) {
            camera.projection = projection;
            for (const glm::uvec2 pixels : {glm::uvec2(1, 1), glm::uvec2(512, 512), glm::uvec2(33, 7)}) {
                const Ray ray = ray_at(ray_planes(camera, pixels, volume), 0.5 * pixels.x, 0.5 * pixels.y);
                CHECK(distance_to(ray, camera.target / volume.spacing) < 1e-9);
            }
        }
    }
}

TEST_CASE("the picture is not mirrored: x to the right and z up from the front")
{
    const VolumeInfo volume = volume_of_size({10, 20, 30}, {3.0, 2.0, 1.0});
    struct Case {
        const char* side;
        glm::dvec3 right, down, forward;
    };
    for (const Case& expected :
         {Case{"front", {1, 0, 0}, {0, 0, -1}, {0, 1, 0}}, Case{"back", {-1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
          Case{"left", {0, -1, 0}, {0, 0, -1}, {1, 0, 0}}, Case{"right", {0, 1, 0}, {0, 0, -1}, {-1, 0, 0}},
          Case{"top", {1, 0, 0}, {0, -1, 0}, {0, 0, -1}}, Case{"bottom", {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}}}) {
        CAPTURE(expected.side);
        const RayPlanes planes = ray_planes(camera_looking(expected.side, volume), {100, 100}, volume);
        CHECK(glm::distance(glm::normalize(planes.near_dx), expected.right) < 1e-12);
        CHECK(glm::distance(glm::normalize(planes.near_dy), expected.down) < 1e-12);
        const Ray ray = ray_at(planes, 50, 50);
        CHECK(glm::distance(glm::normalize(ray.far_point - ray.near_point), expected.forward) < 1e-12);
    }
    CHECK_THROWS_WITH(camera_looking("frnt", volume),
                      "camera side is \"frnt\"; expected one of front, back, left, right, top, bottom");
}

TEST_CASE("a camera that looks at the volume holds all of it with 5 % to spare")
{
    const VolumeInfo volume = volume_of_size({64, 32, 16}, {1.0, 3.0, 2.0});
    const double radius = glm::length(centre_of(volume));
    for (const std::string& side : camera_sides()) {
        const Camera camera = camera_looking(side, volume);
        CHECK(camera.target == centre_of(volume));
        const double distance = glm::distance(camera.eye, camera.target);
        CHECK(std::asin(radius / distance) == doctest::Approx(15.0 * 3.14159265358979 / 180.0 / 1.05).epsilon(2e-3));
    }
}

TEST_CASE("pixels are square in physical units, whatever the aspect and the spacing")
{
    const VolumeInfo volume = volume_of_size({64, 64, 64}, {1.0, 1.0, 20.0});
    const RayPlanes planes = ray_planes(camera_looking("front", volume), {640, 200}, volume);
    CHECK(glm::length(planes.far_dx * volume.spacing) ==
          doctest::Approx(glm::length(planes.far_dy * volume.spacing)).epsilon(1e-13));
    CHECK(glm::length(planes.far_dx) == doctest::Approx(20.0 * glm::length(planes.far_dy)).epsilon(1e-13));
}

TEST_CASE("rays are accurate to 1e-9 voxels from 1e-3 to 1e7 volume sizes away")
{
    const VolumeInfo volume = volume_of_size({64, 48, 56}, {1.0, 1.5, 0.75});
    const glm::dvec3 centre = centre_of(volume);
    const double radius = glm::length(centre);
    const glm::dvec3 back = glm::normalize(glm::dvec3(0.31, -0.77, 0.42));
    const glm::uvec2 pixels(400, 300);
    for (double sizes = 1e-3; sizes < 2e7; sizes *= 10.0) {
        CAPTURE(sizes);
        Camera camera;
        camera.target = centre + glm::dvec3(1.25, -2.5, 0.125);
        camera.eye = camera.target + back * (sizes * 64.0);
        // Keeps the volume filling the picture, as a telescope would.
        camera.fov_y_degrees = std::min(60.0, 2.2 * radius / (sizes * 64.0) * 57.3);
        const RayPlanes planes = ray_planes(camera, pixels, volume);
        REQUIRE_FALSE(planes.empty);
        for (const glm::dvec2 at : {glm::dvec2(0.5, 0.5), glm::dvec2(399.5, 0.5), glm::dvec2(200, 150),
                                    glm::dvec2(123.5, 299.5), glm::dvec2(310.5, 40.5)}) {
            const Ray ray = ray_at(planes, at.x, at.y);
            test::check_below("near point, voxels",
                              double(miss_of_exact_ray(camera, pixels, volume, at.x, at.y, ray.near_point)), 1e-9);
            test::check_below("far point, voxels",
                              double(miss_of_exact_ray(camera, pixels, volume, at.x, at.y, ray.far_point)), 1e-9);
            const glm::dvec3 middle = 0.5 * (ray.near_point + ray.far_point);
            test::check_below("middle, voxels", double(miss_of_exact_ray(camera, pixels, volume, at.x, at.y, middle)),
                              1e-9);
        }
    }
}

TEST_CASE("the planes touch the bounding sphere, and give way to tighter clip planes")
{
    const VolumeInfo volume = volume_of_size({10, 10, 10});
    const double radius = std::sqrt(75.0);
    Camera camera = camera_looking("front", volume);
    const double distance = glm::distance(camera.eye, camera.target);
    const auto depths = [&](double near_distance, double far_distance) {
        camera.near_distance = near_distance;
        camera.far_distance = far_distance;
        const Ray ray = ray_at(ray_planes(camera, {64, 64}, volume), 32, 32);
        return glm::dvec2(ray.near_point.y - camera.eye.y, ray.far_point.y - camera.eye.y);
    };
    for (const auto projection : {Camera::Projection::perspective, Camera::Projection::orthographic}) {
        camera.projection = projection;
        CHECK(glm::distance(depths(0, 0), glm::dvec2(distance - radius, distance + radius)) < 1e-12);
        CHECK(glm::distance(depths(distance - 2, 0), glm::dvec2(distance - 2, distance + radius)) < 1e-12);
        CHECK(glm::distance(depths(1, distance + 3), glm::dvec2(distance - radius, distance + 3)) < 1e-12);
        CHECK(glm::distance(depths(0, 1e9), glm::dvec2(distance - radius, distance + radius)) < 1e-12);
    }
}

TEST_CASE("an eye inside the volume sees from just before itself")
{
    const VolumeInfo volume = volume_of_size({10, 10, 10}, {0.5, 1.0, 2.0});
    Camera camera;
    camera.eye = centre_of(volume);
    camera.target = camera.eye + glm::dvec3(0, 1, 0);
    const RayPlanes planes = ray_planes(camera, {64, 64}, volume);
    const Ray ray = ray_at(planes, 32, 32);
    CHECK(ray.near_point.y - 5.0 == doctest::Approx(0.5e-6).epsilon(1e-8));
    camera.projection = Camera::Projection::orthographic;
    const Ray parallel = ray_at(ray_planes(camera, {64, 64}, volume), 32, 32);
    CHECK(parallel.near_point.y == 5.0);
}

TEST_CASE("nothing is between the planes where near is behind far or the volume out of reach")
{
    const VolumeInfo volume = volume_of_size({10, 10, 10});
    for (const auto projection : {Camera::Projection::perspective, Camera::Projection::orthographic}) {
        Camera camera = camera_looking("top", volume);
        camera.projection = projection;
        camera.near_distance = 40.0;
        camera.far_distance = 30.0;
        CHECK(ray_planes(camera, {8, 8}, volume).empty);
        camera.near_distance = 40.0;
        camera.far_distance = 40.0;
        CHECK(ray_planes(camera, {8, 8}, volume).empty);
        camera.near_distance = 0.0;
        camera.far_distance = 1.0;
        CHECK(ray_planes(camera, {8, 8}, volume).empty);
        camera.near_distance = 1000.0;
        camera.far_distance = 0.0;
        CHECK(ray_planes(camera, {8, 8}, volume).empty);
        camera.near_distance = 0.0;
        camera.target = camera.eye + (camera.eye - camera.target);  // looks away
        CHECK(ray_planes(camera, {8, 8}, volume).empty);
    }
}

TEST_CASE("shares tell where the clip range and the target lie, also where the volume is out of reach")
{
    const VolumeInfo volume = volume_of_size({10, 10, 10});
    for (const auto projection : {Camera::Projection::perspective, Camera::Projection::orthographic})
        for (const double near : {0.0, 5.0, 28.0, 1000.0}) {
            CAPTURE(near);
            Camera camera = camera_looking("top", volume);
            camera.projection = projection;
            camera.near_distance = near;
            camera.far_distance = near + 7.0;
            const RayPlanes planes = ray_planes(camera, {8, 8}, volume);
            const auto depth = [&](double share) {
                const Ray ray = ray_at(planes, 4.0, 4.0);
                const glm::dvec3 at = glm::mix(ray.near_point, ray.far_point, share);
                return glm::dot(at - camera.eye, glm::normalize(camera.target - camera.eye));
            };
            const double hair = projection == Camera::Projection::perspective ? 1e-6 : 0.0;
            CHECK(depth(planes.begin) == doctest::Approx(std::max(near, hair)).epsilon(1e-9));
            CHECK(depth(planes.end) == doctest::Approx(near + 7.0).epsilon(1e-9));
            CHECK((planes.middle >= 0.0 && planes.middle <= 1.0));
            camera.far_distance = 0.0;
            CHECK(ray_planes(camera, {8, 8}, volume).end == INFINITY);
        }
    Camera camera = camera_looking("top", volume);
    camera.target = camera.eye + 0.9 * (camera.target - camera.eye);
    const RayPlanes planes = ray_planes(camera, {8, 8}, volume);
    const Ray ray = ray_at(planes, 4.0, 4.0);
    CHECK(glm::distance(glm::mix(ray.near_point, ray.far_point, planes.middle), camera.target) < 1e-9);
}

TEST_CASE("orthographic rays are parallel to the last bit")
{
    const VolumeInfo volume = volume_of_size({64, 64, 64}, {1.0, 1.1, 1.3});
    Camera camera = camera_looking("left", volume);
    camera.eye += glm::dvec3(1e6, 3.0, -17.0);
    camera.projection = Camera::Projection::orthographic;
    camera.eye.x = -1e6;
    const RayPlanes planes = ray_planes(camera, {512, 256}, volume);
    CHECK(planes.near_dx == planes.far_dx);
    CHECK(planes.near_dy == planes.far_dy);
    CHECK(glm::length(planes.near_dy * volume.spacing) * 256 == doctest::Approx(camera.height).epsilon(1e-13));
}

TEST_CASE("degenerate cameras are refused")
{
    const VolumeInfo volume = volume_of_size({10, 10, 10});
    const Camera good = camera_looking("front", volume);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double infinity = std::numeric_limits<double>::infinity();
    const auto refused = [&](auto change) {
        Camera camera = good;
        change(camera);
        CHECK_THROWS_AS(check_camera(camera), Error);
        CHECK_THROWS_AS(ray_planes(camera, {8, 8}, volume), Error);
    };
    CHECK_NOTHROW(check_camera(good));
    refused([](Camera& camera) { camera.eye = camera.target; });
    refused([](Camera& camera) { camera.up = {0, -3, 0}; });
    refused([](Camera& camera) { camera.up = {0, 1, 1e-8}; });
    refused([](Camera& camera) { camera.up = {0, 0, 0}; });
    for (const double bad : {nan, infinity}) {
        refused([&](Camera& camera) { camera.eye.x = bad; });
        refused([&](Camera& camera) { camera.target.y = bad; });
        refused([&](Camera& camera) { camera.up.z = bad; });
    }
    for (const double bad : {nan, infinity, 0.0, -30.0, 180.0}) {
        refused([&](Camera& camera) { camera.fov_y_degrees = bad; });
    }
    for (const double bad : {nan, infinity, 0.0, -1.0}) {
        refused([&](Camera& camera) {
            camera.projection = Camera::Projection::orthographic;
            camera.height = bad;
        });
    }
    for (const double bad : {nan, infinity, -1.0}) {
        refused([&](Camera& camera) { camera.near_distance = bad; });
        refused([&](Camera& camera) { camera.far_distance = bad; });
    }
    refused([](Camera& camera) { camera.eye.y = 1e300; });
    Camera parallel = good;
    parallel.up = {0, 1, 0};
    CHECK_THROWS_WITH(check_camera(parallel),
                      doctest::Contains("expected an up that is neither zero nor parallel to the view direction"));
}

TEST_CASE("a side view turns to the viewer's right, tilts upwards and comes closer")
{
    const VolumeInfo volume = volume_of_size({64, 32, 16}, {1.0, 3.0, 2.0});
    const auto check_equal = [](const Camera& a, const Camera& b) {
        CHECK(glm::distance(a.eye, b.eye) < 1e-9);
        CHECK(glm::distance(a.target, b.target) < 1e-9);
        CHECK(glm::distance(a.up, b.up) < 1e-12);
    };
    CHECK(camera_of(SideView{.side = "left"}, volume) == camera_looking("left", volume));
    check_equal(camera_of(SideView{.side = "front", .turn_degrees = 90}, volume), camera_looking("right", volume));
    check_equal(camera_of(SideView{.side = "front", .turn_degrees = -90}, volume), camera_looking("left", volume));
    check_equal(camera_of(SideView{.side = "right", .turn_degrees = 90}, volume), camera_looking("back", volume));
    check_equal(camera_of(SideView{.side = "front", .tilt_degrees = 90}, volume), camera_looking("top", volume));
    const Camera far_camera = camera_looking("front", volume);
    const Camera near_camera = camera_of(SideView{.side = "front", .zoom = 2.0}, volume);
    CHECK(glm::distance(near_camera.eye, near_camera.target) ==
          doctest::Approx(0.5 * glm::distance(far_camera.eye, far_camera.target)).epsilon(1e-13));
    CHECK(camera_of(far_camera, volume) == far_camera);
}

TEST_CASE("a stack of few slices is looked at from its largest face, and everything else from the front")
{
    struct Case {
        glm::dvec3 extent;
        const char* side;
    };
    for (const Case& c : {Case{{512, 512, 512}, "front"},
                          {{512, 512, 256}, "front"},  // half of the largest face is enough
                          {{512, 512, 255}, "top"},
                          {{512, 512, 1}, "top"},
                          {{512, 1, 512}, "front"},
                          {{1, 512, 512}, "right"},
                          {{255, 512, 512}, "right"},
                          {{168, 165, 641}, "front"},
                          {{641, 168, 165}, "front"},
                          {{165, 641, 168}, "right"},  // otherwise seen from its end
                          {{100, 1000, 100}, "right"},
                          {{100, 1000, 99}, "top"}}) {
        CAPTURE(c.extent.x);
        CAPTURE(c.extent.y);
        CAPTURE(c.extent.z);
        VolumeInfo volume;
        volume.size = {8, 4, 2};
        volume.spacing = c.extent / glm::dvec3(volume.size);
        CHECK(side_of_largest_face(volume) == c.side);
        volume.spacing *= 0x1p-40;
        CHECK(side_of_largest_face(volume) == c.side);
    }
}

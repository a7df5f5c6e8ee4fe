#include "tests/support/gpu.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "tests/support/at_end.h"
#include "tests/support/volume_files.h"

namespace shvr::test {

namespace {

constexpr double MAX_CODE = 65535.0;

Renderer& renderer_of_the_process()
{
    static std::unique_ptr<Renderer> renderer;
    if (!renderer) {
        renderer = std::make_unique<Renderer>(Renderer::Options{.device = {.device = "", .validation = true}});
        at_end([] { renderer.reset(); });  // the validation layer's own statics are still there
    }
    return *renderer;
}

template <class T>
std::unique_ptr<VolumeSource> source_as(const TestVolume& volume)
{
    std::vector<std::byte> bytes(volume.voxels.size() * sizeof(T));
    for (size_t i = 0; i < volume.voxels.size(); ++i) {
        const T voxel = static_cast<T>(volume.voxels[i]);
        std::memcpy(bytes.data() + i * sizeof(T), &voxel, sizeof(T));
    }
    return std::make_unique<MemorySource>(volume.info(), std::move(bytes));
}

/// The densities of exactly the codes that the device holds.
std::vector<double> densities_of(const TestVolume& volume)
{
    const IntensityWindow window = volume.window();
    std::vector<double> densities;
    for (const double voxel : volume.voxels) {
        const double code = std::clamp(std::floor(window.code_of(voxel) + 0.5), 0.0, MAX_CODE);
        densities.push_back(code / MAX_CODE);
    }
    return densities;
}

/// Lights move with the camera: right, up, back.
glm::dvec3 light_of(const Light& light, const Camera& camera)
{
    const glm::dvec3 local = light.direction == glm::dvec3(0.0) ? glm::dvec3(0.3, 0.5, 1.0) : light.direction;
    const glm::dvec3 back = glm::normalize(camera.eye - camera.target);
    const glm::dvec3 right = glm::normalize(glm::cross(camera.up, back));
    return local.x * right + local.y * glm::cross(back, right) + local.z * back;
}

}  // namespace

VolumeInfo TestVolume::info() const
{
    VolumeInfo info{.name = "test", .format = "memory", .size = Size3(size), .type = type};
    info.spacing = spacing;
    return info;
}

TestVolume volume_of(const glm::ivec3& size, const std::function<double(const glm::dvec3& voxel)>& value)
{
    TestVolume volume{.size = size};
    for (int z = 0; z < size.z; ++z)
        for (int y = 0; y < size.y; ++y)
            for (int x = 0; x < size.x; ++x) volume.voxels.push_back(std::round(value(glm::dvec3(x, y, z) + 0.5)));
    return volume;
}

TestVolume constant_volume(const glm::ivec3& size, double value)
{
    return volume_of(size, [&](const glm::dvec3&) { return value; });
}

TestVolume noise_volume(const glm::ivec3& size, uint32_t seed)
{
    std::mt19937 random(seed);
    return volume_of(size, [&](const glm::dvec3&) { return double(random() >> 16); });
}

double value_at(const TestVolume& volume, const glm::dvec3& voxel)
{
    const glm::dvec3 lattice = voxel - 0.5, corner = glm::floor(lattice), f = lattice - corner;
    double sum = 0.0, least = std::numeric_limits<double>::infinity(), most = -least;
    for (int i = 0; i < 8; ++i) {
        const glm::ivec3 half(i & 1, i >> 1 & 1, i >> 2);
        const glm::ivec3 at = glm::clamp(glm::ivec3(corner) + half, glm::ivec3(0), volume.size - 1);
        const glm::dvec3 weights = glm::mix(1.0 - f, f, glm::dvec3(half));
        const double corner_value = volume.voxels[size_t(at.x + volume.size.x * (at.y + volume.size.y * at.z))];
        sum += weights.x * weights.y * weights.z * corner_value;
        least = std::min(least, corner_value), most = std::max(most, corner_value);
    }
    return std::clamp(sum, least, most);  // rounding must not pass the end of a transfer function
}

std::unique_ptr<VolumeSource> source_of(const TestVolume& volume)
{
    switch (volume.type) {
        case VoxelType::uint8: return source_as<uint8_t>(volume);
        case VoxelType::int8: return source_as<int8_t>(volume);
        case VoxelType::uint16: return source_as<uint16_t>(volume);
        case VoxelType::int16: return source_as<int16_t>(volume);
        case VoxelType::uint32: return source_as<uint32_t>(volume);
        case VoxelType::int32: return source_as<int32_t>(volume);
        case VoxelType::float32: return source_as<float>(volume);
        case VoxelType::float64: return source_as<double>(volume);
    }
    return nullptr;
}

Session plain_session(std::vector<ControlPoint> points, const glm::uvec2& pixels)
{
    Session session;
    session.transfer_function = TransferFunction(std::move(points));
    session.light.shaded = false;
    session.render.size = pixels;
    session.render.opacity_limit = 1.0;
    session.render.background = {0.0, 0.0, 0.0, 1.0};
    session.render.sampling = Sampling::exact;
    return session;
}

std::vector<ControlPoint> busy_points(double densest)
{
    return {{0.0, RED, 0.0},
            {15000.0, GREEN, 0.5 * densest},
            {30000.0, BLUE, 0.1 * densest},
            {50000.0, WHITE, densest},
            {65535.0, RED, 0.0}};
}

std::vector<ControlPoint> unseen_points()
{
    return {{70000.0, WHITE, 0.0}, {80000.0, WHITE, 1.0}};
}

std::vector<ControlPoint> uniform_points(const glm::dvec3& color, double opacity)
{
    return {{0.0, color, opacity}, {MAX_CODE, color, opacity}};
}

Camera camera_along(const TestVolume& volume, const glm::dvec3& direction, double height)
{
    const glm::dvec3 extent = glm::dvec3(volume.size) * volume.spacing;
    const glm::dvec3 forward = glm::normalize(direction);
    Camera camera;
    camera.projection = Camera::Projection::orthographic;
    camera.target = 0.5 * extent;
    camera.eye = camera.target - forward * glm::length(extent);
    camera.up = std::abs(forward.z) > 0.9 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(0.0, 0.0, 1.0);
    camera.height = height;
    return camera;
}

Camera perspective(const glm::dvec3& eye, const glm::dvec3& target, double fov_y_degrees)
{
    Camera camera{.eye = eye, .target = target, .fov_y_degrees = fov_y_degrees};
    const glm::dvec3 forward = glm::normalize(target - eye);
    if (std::abs(forward.z) > 0.9) camera.up = {0.0, 1.0, 0.0};
    return camera;
}

std::vector<glm::dvec3> cube_directions()
{
    std::vector<glm::dvec3> directions;
    for (int i = 0; i < 27; ++i)
        if (i != 13) directions.emplace_back(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    return directions;
}

double opacity_of_depth(double depth)
{
    return -std::expm1(-depth);
}

double depth_of_opacity(double opacity)
{
    return -std::log1p(-opacity);
}

Pixels pixels_of(const ImageF& image)
{
    Pixels pixels;
    for (size_t i = 0; i + 3 < image.rgba.size(); i += 4)
        pixels.emplace_back(image.rgba[i], image.rgba[i + 1], image.rgba[i + 2], image.rgba[i + 3]);
    return pixels;
}

double worst_difference(const Pixels& a, const Pixels& b)
{
    REQUIRE(a.size() == b.size());
    double worst = 0.0;
    for (size_t i = 0; i < a.size(); ++i) {
        const glm::dvec4 difference = glm::abs(a[i] - b[i]);
        worst = std::max({worst, difference.x, difference.y, difference.z, difference.w});
    }
    return worst;
}

double rms_difference(const Pixels& a, const Pixels& b)
{
    REQUIRE(a.size() == b.size());
    double sum = 0.0;
    for (size_t i = 0; i < a.size(); ++i) sum += glm::dot(a[i] - b[i], a[i] - b[i]);
    return std::sqrt(sum / (4.0 * double(a.size())));
}

size_t different_bits(const ImageF& a, const ImageF& b)
{
    REQUIRE(a.rgba.size() == b.rgba.size());
    size_t count = 0;
    for (size_t i = 0; i < a.rgba.size(); ++i)
        count += std::bit_cast<uint32_t>(a.rgba[i]) != std::bit_cast<uint32_t>(b.rgba[i]);
    return count;
}

OnDevice::OnDevice() : renderer_(renderer_of_the_process())
{
    static_cast<void>(renderer_.device().take_validation_messages());
}

OnDevice::~OnDevice()
{
    for (const std::string& message : renderer_.device().take_validation_messages()) FAIL_CHECK(message);
}

void OnDevice::load(TestVolume volume, Sampling sampling)
{
    volume_ = std::move(volume);
    VolumeStatistics statistics;
    statistics.minimum = volume_.minimum;
    statistics.maximum = volume_.maximum;
    renderer_.load(source_of(volume_), statistics, {.sampling = sampling});
}

ImageF OnDevice::draw(const Session& session, const Camera& camera)
{
    Picture picture = renderer_.render(session, camera);
    CHECK(picture.complete);
    CHECK(count_not_finite(picture.image) == 0);
    return std::move(picture.image);
}

std::vector<uint64_t> OnDevice::work(const Session& session, const Camera& camera)
{
    const Picture picture = renderer_.render(session, camera, {.count_work = true});
    for (const gpu::PassReport& pass : picture.passes)
        if (pass.name == "raycast") return pass.counters;
    return {};
}

Pixels OnDevice::expected(const Session& session, const Camera& camera, const reference::Mode& mode) const
{
    const reference::Scene scene = scene_of(volume_, session, camera);
    Pixels pixels = reference::render(scene, rays_of(volume_, session, camera), mode);
    const glm::dvec4 background = session.render.background;
    for (glm::dvec4& pixel : pixels) {
        const double through = (1.0 - pixel.a) * background.a;
        pixel += glm::dvec4(through * glm::dvec3(background), through);
    }
    return pixels;
}

Pixels OnDevice::discrete(const Session& session, const Camera& camera) const
{
    return expected(session, camera, tabulated(volume_, session));
}

double OnDevice::error(const Session& session, const Camera& camera)
{
    return worst_difference(pixels_of(draw(session, camera)), discrete(session, camera));
}

reference::DiscreteOptions tabulated(const TestVolume& volume, const Session& session)
{
    const TableRange range = table_range(session.transfer_function, volume.window(), false);
    return {.step = session.render.step_voxels, .table_entries = range.samples.entries};
}

namespace {

/// The range, along a direction in physical space, of what the cuts leave of the volume: the extremes are among the
/// points where three of its planes meet.
std::pair<double, double> extent_of(const reference::Scene& scene, const glm::dvec3& direction)
{
    const glm::dvec3 lower = glm::max(scene.cut_min, glm::dvec3(0.0));
    const glm::dvec3 upper = glm::min(scene.cut_max, glm::dvec3(scene.size));
    std::vector<glm::dvec4> planes{scene.cut_plane};  // outside where dot(xyz, voxel) + w > 0
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec4 far(0.0, 0.0, 0.0, -upper[axis]), near(0.0, 0.0, 0.0, lower[axis]);
        far[axis] = 1.0;
        near[axis] = -1.0;
        planes.insert(planes.end(), {far, near});
    }
    double nearest = std::numeric_limits<double>::infinity(), farthest = -nearest;
    for (size_t i = 0; i < planes.size(); ++i)
        for (size_t j = i + 1; j < planes.size(); ++j)
            for (size_t k = j + 1; k < planes.size(); ++k) {
                const glm::dmat3 rows(glm::dvec3(planes[i]), glm::dvec3(planes[j]), glm::dvec3(planes[k]));
                if (std::abs(glm::determinant(rows)) < 1e-12) continue;
                const glm::dvec3 at =
                    glm::inverse(glm::transpose(rows)) * -glm::dvec3(planes[i].w, planes[j].w, planes[k].w);
                const bool is_left = std::ranges::all_of(
                    planes, [&](const glm::dvec4& plane) { return glm::dot(plane, glm::dvec4(at, 1.0)) < 1e-9; });
                if (!is_left) continue;
                const double depth = glm::dot(at * scene.spacing, direction);
                nearest = std::min(nearest, depth);
                farthest = std::max(farthest, depth);
            }
    return {nearest, farthest};
}

}  // namespace

reference::Scene scene_of(const TestVolume& volume, const Session& session, const Camera& camera)
{
    const IntensityWindow window = volume.window();
    reference::Scene scene;
    scene.size = volume.size;
    scene.density = densities_of(volume);
    scene.spacing = volume.spacing;
    for (const ControlPoint& point : session.transfer_function.points())
        scene.points.push_back({window.code_of(point.intensity) / MAX_CODE, point.color, point.opacity});
    scene.cut_min = session.cut.lower;
    scene.cut_max = session.cut.upper;
    if (const auto& normal = session.cut.plane_normal) {
        const glm::dvec3 point = session.cut.plane_point.value_or(0.5 * glm::dvec3(volume.size));
        scene.cut_plane = {*normal * volume.spacing, -glm::dot(*normal, point * volume.spacing)};
    }
    if (session.light.shaded) {
        const double range = (volume.maximum - volume.minimum) * window.codes_per_unit / MAX_CODE;
        scene.shading = reference::Shading{.ambient = session.light.ambient,
                                           .diffuse = session.light.diffuse,
                                           .specular = session.light.specular,
                                           .shininess = session.light.shininess,
                                           .fade = session.light.gradient_fade * range,
                                           .to_light = light_of(session.light, camera),
                                           .has_analytic_gradient = session.render.gradient == Gradient::analytic};
    }
    if (session.blend.size > 0.0) {
        const glm::dvec3 forward = glm::normalize(camera.target - camera.eye);
        const auto [nearest, farthest] = extent_of(scene, forward);
        const double at_eye = glm::dot(camera.eye, forward);
        scene.blend =
            reference::DistanceBlend{.color = session.blend.color.value_or(glm::dvec3(session.render.background)),
                                     .size = session.blend.size,
                                     .rate = session.blend.rate,
                                     .forward = forward,
                                     .begin = std::max(nearest, at_eye + camera.near_distance),
                                     .end = farthest};
    }
    return scene;
}

std::vector<reference::Ray> rays_of(const TestVolume& volume, const Session& session, const Camera& camera)
{
    const glm::uvec2 pixels = session.render.size;
    const RayPlanes planes = ray_planes(camera, pixels, volume.info());
    std::vector<reference::Ray> rays;
    for (uint32_t y = 0; y < pixels.y; ++y) {
        for (uint32_t x = 0; x < pixels.x; ++x) {
            const double dx = x + 0.5, dy = y + 0.5;
            const glm::dvec3 near = planes.near_corner + dx * planes.near_dx + dy * planes.near_dy;
            const glm::dvec3 far = planes.far_corner + dx * planes.far_dx + dy * planes.far_dy;
            const glm::dvec3 direction = planes.empty ? glm::dvec3(0.0) : far - near;
            rays.push_back({.origin = near, .direction = direction, .t_min = 0.0, .t_max = 1.0});
        }
    }
    return rays;
}

}  // namespace shvr::test

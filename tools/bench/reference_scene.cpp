#include "tools/bench/reference_scene.h"

#include <algorithm>
#include <cmath>
#include <thread>

#include "engine/bricks/code_rows.h"
#include "tests/reference/field.h"
#include "tests/reference/occlusion.h"

namespace shvr::bench {

namespace {

constexpr double MAX_CODE = 65535.0;
// Number of directions of the reference's ambient occlusion: enough for an error far below that of the pictures
// compared (tests/gpu/occlusion/occlusion_test.cpp).
constexpr uint32_t OCCLUSION_DIRECTIONS = 128;
constexpr int OCCLUSION_STEPS = 32;

/// Returns the codes that the device holds, scaled to the range from 0 to 1.
std::vector<double> densities(const VolumeSource& source, const IntensityWindow& window)
{
    const VolumeInfo& info = source.info();
    const CodeRows rows(info.type, window);
    const auto slice_voxels = size_t(info.size.x * info.size.y);
    std::vector<std::byte> voxels(slice_voxels * bytes_of(info.type));
    std::vector<uint16_t> codes(slice_voxels);
    std::vector<double> density;
    density.reserve(size_t(voxel_count(info)));
    for (int64_t z = 0; z < info.size.z; ++z) {
        source.read({{0, 0, z}, {info.size.x, info.size.y, z + 1}}, voxels);
        rows.convert(voxels, codes);
        for (const uint16_t code : codes) density.push_back(code / MAX_CODE);
    }
    return density;
}

std::vector<uint8_t> labels_of(const Mask& mask, const Size3& size)
{
    std::vector<uint8_t> labels;
    labels.reserve(size_t(size.x * size.y * size.z));
    for (int64_t z = 0; z < size.z; ++z)
        for (int64_t y = 0; y < size.y; ++y)
            for (int64_t x = 0; x < size.x; ++x) labels.push_back(mask.at({x, y, z}));
    return labels;
}

/// Returns the direction to a light, which moves with the camera; 0, 0, 0 means a light over the viewer's shoulder.
glm::dvec3 to_light(const glm::dvec3& stated, const Camera& camera)
{
    const glm::dvec3 along = stated == glm::dvec3(0.0) ? glm::dvec3(0.3, 0.5, 1.0) : stated;
    const glm::dvec3 back = glm::normalize(camera.eye - camera.target);
    const glm::dvec3 right = glm::normalize(glm::cross(camera.up, back));
    return glm::dmat3(right, glm::cross(back, right), back) * along;
}

/// Opacity per reference length as a function of position; 0 outside the drawn region.
class OpacityField {
public:
    explicit OpacityField(const reference::Scene& scene) : scene_(scene), transfer_(scene.points) {}

    double at(const glm::dvec3& voxel) const
    {
        const bool is_inside = glm::all(glm::greaterThanEqual(voxel, glm::max(glm::dvec3(0.0), scene_.cut_min))) &&
                               glm::all(glm::lessThan(voxel, glm::min(glm::dvec3(scene_.size), scene_.cut_max)));
        if (!is_inside) return 0.0;
        if (const uint8_t label = reference::label_at(scene_, voxel)) {
            const reference::Group& group = scene_.groups[label];
            return group.visible ? group.opacity : 0.0;
        }
        return transfer_.at(reference::density_at(scene_, voxel)).a;
    }

    /// Returns whether any of the positions sampled within a voxel of `centre` is visible.
    bool shows_near(const glm::dvec3& centre) const
    {
        for (int corner = 0; corner < 27; ++corner) {
            const glm::dvec3 away(corner % 3 - 1, corner / 3 % 3 - 1, corner / 9 - 1);
            for (const double reach : {0.5, 1.0})
                if (at(centre + reach * away) > 0.0) return true;
        }
        return false;
    }

private:
    const reference::Scene& scene_;
    reference::Transfer transfer_;
};

/// Returns the normal and strength of the surface at a voxel, by central differences over two voxels (occlusion.h).
reference::OcclusionSide side_at(const reference::Scene& scene, const glm::dvec3& centre, const glm::dvec3& per_unit)
{
    glm::dvec3 slope(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 step(0.0);
        step[axis] = 1.0;
        slope[axis] = 0.5 * (reference::density_at(scene, centre + step) - reference::density_at(scene, centre - step));
    }
    const double square = glm::dot(slope, slope), fade = scene.shading->fade;
    if (square == 0.0) return {};
    return {-glm::normalize(slope * per_unit), square / (square + fade * fade), -slope / std::sqrt(square)};
}

std::vector<double> ambient_shares(const reference::Scene& scene, const OcclusionSettings& settings)
{
    const OpacityField field(scene);
    const reference::OcclusionAsked asked{.radius = settings.radius,
                                          .full_sphere = settings.full_sphere,
                                          .voxels_per_unit = reference::reference_length(scene) / scene.spacing};
    std::vector<double> shares(scene.density.size(), 1.0);
    const auto of_slices = [&](int first, int stride) {
        for (int z = first; z < scene.size.z; z += stride)
            for (int y = 0; y < scene.size.y; ++y)
                for (int x = 0; x < scene.size.x; ++x) {
                    const glm::dvec3 centre(x + 0.5, y + 0.5, z + 0.5);
                    if (!field.shows_near(centre)) continue;
                    const double value = reference::occlusion_defined(
                        [&](const glm::dvec3& voxel) { return field.at(voxel); }, asked, {x, y, z},
                        side_at(scene, centre, asked.voxels_per_unit), OCCLUSION_DIRECTIONS, OCCLUSION_STEPS);
                    const double curved = seen_of(settings, std::clamp(value, 1e-4, 1.0));
                    shares[size_t(x) + size_t(scene.size.x) * (size_t(y) + size_t(scene.size.y) * size_t(z))] =
                        1.0 - settings.strength * (1.0 - curved);
                }
    };
    {
        std::jthread other([&] { of_slices(1, 2); });
        of_slices(0, 2);
    }
    return shares;
}

void refuse_what_is_unknown(const Session& session, const VolumeInfo& info)
{
    const auto refuse = [](const std::string& what) {
        fail("the reference renderer does not draw ", what, "; expected a session without");
    };
    if (session.blend.size != 0.0) refuse("distance blending");
    if (session.render.saturation != 1.0) refuse("saturation");
    if (session.probe.shown || session.probe.shell || session.probe.preview) refuse("the probe");
    for (const SurfaceLook& surface : session.surfaces)
        if (surface.from != surface.to) refuse("rods");
    if (voxel_count(info) > MAX_REFERENCE_VOXELS)
        fail("the volume has ", voxel_count(info), " voxels; expected at most ", MAX_REFERENCE_VOXELS,
             ", which the reference renderer keeps in 8 bytes each");
}

/// Returns the ray parameter of the first intersection with a ball; null if the ray misses the ball, or meets it only
/// before t_min.
std::optional<double> first_hit(const Ball& ball, const reference::Ray& ray, const glm::dvec3& spacing)
{
    const glm::dvec3 along = ray.direction * spacing, from = ray.origin * spacing - ball.center;
    const double a = glm::dot(along, along), b = glm::dot(from, along),
                 c = glm::dot(from, from) - ball.radius * ball.radius;
    const double square = b * b - a * c;
    if (!(a > 0.0) || square < 0.0) return std::nullopt;
    const double near = (-b - std::sqrt(square)) / a, far = (-b + std::sqrt(square)) / a;
    if (far < ray.t_min || near > ray.t_max) return std::nullopt;
    return std::max(near, ray.t_min);
}

/// Returns the Blinn-Phong lighting of a surface with an exact normal, to which no fading applies.
glm::dvec3 lit(const Ball& ball, const reference::Shading& light, const glm::dvec3& normal, const glm::dvec3& to_eye)
{
    const glm::dvec3 towards = glm::normalize(light.to_light), sum = towards + to_eye;
    const double facing = std::max(glm::dot(normal, towards), 0.0);
    const double mirrored = glm::length(sum) > 1e-6 ? std::max(glm::dot(normal, glm::normalize(sum)), 0.0) : 0.0;
    const double highlight = facing > 0.0 ? light.specular * std::pow(mirrored, light.shininess) : 0.0;
    return glm::min(ball.color * (light.ambient + light.diffuse * facing) + highlight, glm::dvec3(1.0));
}

reference::Shading light_of(const Session& session, const Camera& camera, double range)
{
    return {.ambient = session.light.ambient,
            .diffuse = session.light.diffuse,
            .specular = session.light.specular,
            .shininess = session.light.shininess,
            .fade = session.light.gradient_fade * range / MAX_CODE,
            .to_light = to_light(session.light.direction, camera)};
}

}  // namespace

ReferenceScene reference_scene_of(const Session& session, const VolumeSource& source,
                                  const VolumeStatistics& statistics, const Camera& camera, const Mask* mask)
{
    const VolumeInfo& info = source.info();
    refuse_what_is_unknown(session, info);
    const IntensityWindow window = window_for(info.type, statistics.range().lower, statistics.range().upper);
    ReferenceScene made{.scene = {.size = glm::ivec3(info.size),
                                  .density = densities(source, window),
                                  .spacing = info.spacing,
                                  .cut_min = session.cut.lower,
                                  .cut_max = session.cut.upper},
                        .balls = {}};
    reference::Scene& scene = made.scene;
    for (const ControlPoint& point : session.transfer_function.points())
        scene.points.push_back({window.code_of(point.intensity) / MAX_CODE, point.color, point.opacity});
    if (mask) {
        scene.labels = labels_of(*mask, info.size);
        for (size_t i = 1; i < scene.groups.size(); ++i) {
            const ColorGroup group = group_of(session.groups, uint8_t(i));
            scene.groups[i] = {group.color, group.opacity, group.visible};
        }
    }
    const double range = window.code_of(statistics.range().upper) - window.code_of(statistics.range().lower);
    if (session.light.shaded) {
        scene.shading = light_of(session, camera, range);
        if (shows_occlusion(session.light))
            scene.shading->ambient_shares = ambient_shares(scene, session.light.occlusion);
    }
    for (const SurfaceLook& surface : session.surfaces)
        made.balls.push_back({surface.from, surface.radius_from, surface.color});
    if (!made.balls.empty() && !scene.shading)
        fail("the reference renderer draws surfaces in shaded scenes alone; expected light.shaded to be true");
    return made;
}

std::vector<reference::Ray> rays_through(std::span<const glm::uvec2> pixels, const RayPlanes& planes)
{
    std::vector<reference::Ray> rays;
    for (const glm::uvec2& pixel : pixels) {
        const glm::dvec2 centre = glm::dvec2(pixel) + 0.5;
        const glm::dvec3 near = planes.near_corner + centre.x * planes.near_dx + centre.y * planes.near_dy;
        const glm::dvec3 far = planes.far_corner + centre.x * planes.far_dx + centre.y * planes.far_dy;
        const glm::dvec3 direction = planes.empty ? glm::dvec3(0.0) : far - near;
        rays.push_back({.origin = near, .direction = direction, .t_min = 0.0, .t_max = 1.0});
    }
    return rays;
}

std::vector<glm::dvec4> draw(const ReferenceScene& scene, std::span<const reference::Ray> rays,
                             const reference::Mode& mode, const glm::dvec4& background, int threads)
{
    std::vector<reference::Ray> cut(rays.begin(), rays.end());
    std::vector<const Ball*> met(rays.size(), nullptr);
    for (size_t i = 0; i < cut.size(); ++i)
        for (const Ball& ball : scene.balls)
            if (const std::optional<double> hit = first_hit(ball, cut[i], scene.scene.spacing)) {
                cut[i].t_max = *hit;
                met[i] = &ball;
            }
    std::vector<glm::dvec4> lights = reference::render(scene.scene, cut, mode, threads);
    for (size_t i = 0; i < lights.size(); ++i) {
        if (met[i]) {
            const glm::dvec3 along = glm::normalize(cut[i].direction * scene.scene.spacing);
            const glm::dvec3 at = (cut[i].origin + cut[i].t_max * cut[i].direction) * scene.scene.spacing;
            const glm::dvec3 color = lit(*met[i], *scene.scene.shading, glm::normalize(at - met[i]->center), -along);
            lights[i] += (1.0 - lights[i].a) * glm::dvec4(color, 1.0);
        }
        // The reference's own backgrounds are opaque.
        const double through = (1.0 - lights[i].a) * background.a;
        lights[i] += through * glm::dvec4(glm::dvec3(background), 1.0);
    }
    return lights;
}

}  // namespace shvr::bench

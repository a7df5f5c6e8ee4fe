#include "engine/picture/ray_params.h"

#include <algorithm>
#include <cmath>

#include "engine/look/cut_corners.h"

namespace shvr {

namespace {

double reference_length(const VolumeInfo& info)
{
    return std::min({info.spacing.x, info.spacing.y, info.spacing.z});
}

/// Returns the direction towards the light in volume space. The light has a fixed direction relative to the camera.
glm::dvec3 light_direction(const Light& light, const Camera& camera)
{
    const glm::dvec3 over_the_shoulder(0.3, 0.5, 1.0);
    const glm::dvec3 local = light.direction == glm::dvec3(0.0) ? over_the_shoulder : light.direction;
    const glm::dvec3 back = glm::normalize(camera.eye - camera.target);
    const glm::dvec3 right = glm::normalize(glm::cross(camera.up, back));
    const glm::dvec3 up = glm::cross(back, right);
    return glm::normalize(local.x * right + local.y * up + local.z * back);
}

/// Returns a brighter version of the colour that paint would have, or a warning colour if the brush removes paint.
glm::dvec3 preview_color(const ProbeLook& probe)
{
    constexpr glm::dvec3 WARNING(1.0, 0.52, 0.0), RAISED(0.2, 0.85, 0.95);
    constexpr double LIGHTER = 0.2, DARKEST = 0.05;
    switch (probe.preview->kind) {
        case PaintPreview::Kind::erase: return WARNING;
        case PaintPreview::Kind::density: return RAISED;
        case PaintPreview::Kind::group: break;
    }
    const double most = std::max({probe.color.r, probe.color.g, probe.color.b, DARKEST});
    return glm::mix(probe.color / most, glm::dvec3(1.0), LIGHTER);
}

}  // namespace

void set_planes(gpu::RaycastParams& params, const RayPlanes& planes)
{
    params.near_corner = planes.near_corner;
    params.near_dx = planes.near_dx;
    params.near_dy = planes.near_dy;
    params.far_corner = planes.far_corner;
    params.far_dx = planes.far_dx;
    params.far_dy = planes.far_dy;
}

void set_rays(gpu::RaycastParams& params, const Look& look, const Camera& camera, const VolumeInfo& info,
              const glm::uvec2& pixels)
{
    const RayPlanes planes = ray_planes(camera, pixels, info);
    set_planes(params, planes);
    params.box_lower = glm::max(glm::vec3(look.cut.lower), glm::vec3(0.0f));
    params.box_upper = glm::min(glm::vec3(look.cut.upper), glm::vec3(info.size));
    params.cut_plane = plane_in_voxels(look.cut, info.size, info.spacing);
    const bool cut_away = glm::any(glm::greaterThan(params.box_lower, params.box_upper));
    if (planes.empty || cut_away) params.box_upper = params.box_lower = glm::vec3(-1.0f);
    params.light = light_direction(look.light, camera);
    if (look.blend.size > 0.0)
        params.depth_plane = depth_plane(
            camera,
            corners_left(params.box_lower, params.box_upper, plane_in_voxels(look.cut, info.size, info.spacing)),
            info.spacing);
}

void set_slice(gpu::RaycastParams& params, const Look& look, Scene& scene)
{
    const DeviceVolume& volume = scene.volume();
    const auto [lower, upper] = scene.statistics().range();
    const SliceSettings& slices = look.slices;
    const double black = volume.window().code_of(slices.black.value_or(lower));
    const double white = volume.window().code_of(slices.white.value_or(upper));
    params.slice_black = float(black);
    params.slice_scale = float(1.0 / std::max(white - black, 1e-6));
    params.slice_paint = float(slices.paint_share);
    params.box_lower = glm::vec3(0.0f);
    params.box_upper = glm::vec3(volume.info().size);
    params.cut_plane = glm::vec4(0.0f);
    params.blend_size = 0.0f;
}

void set_shell(RaycastInput& input, const ProbeLook& probe, Scene& scene)
{
    const DeviceVolume& volume = scene.volume();
    if (!probe.shell || !(probe.shell->opacity > 0.0)) return;
    const glm::dvec3& spacing = volume.info().spacing;
    input.shell = probe.shell->is_box ? gpu::SHELL_BOX : gpu::SHELL_BALL;
    input.params.shell_center = probe.center / spacing;
    input.params.shell_reach = probe.radius / spacing;
    input.params.shell_code = float(volume.window().code_of(probe.shell->threshold));
    input.params.shell_color = probe.color;
    input.params.shell_opacity = float(probe.shell->opacity);
}

gpu::RaycastParams raycast_params(const Look& look, const Camera& camera, Scene& scene, const VolumeBinding& binding,
                                  const PicturePart& part, double step_voxels)
{
    const VolumeInfo& info = scene.info();
    const glm::vec3 size(info.size);
    const glm::vec3 last(std::nextafter(size.x, 0.0f), std::nextafter(size.y, 0.0f), std::nextafter(size.z, 0.0f));
    gpu::RaycastParams params{};
    params.pixel_begin = part.begin;
    params.pixel_end = part.end;
    params.target = part.target;
    params.position_limit = last;
    set_rays(params, look, camera, info, part.pixels);
    params.spacing = info.spacing / reference_length(info);
    params.inverse_spacing = reference_length(info) / info.spacing;
    if (binding.pages) {
        params.page_counts = binding.pages->counts;
        params.page_shift = binding.pages->cell_shift;
        params.page_depth = binding.pages->depth;
    }
    params.step = float(step_voxels);
    params.opacity_limit = float(look.render.opacity_limit);
    set_look_table(params, look.transfer_function, scene.volume().window(), look.render.classifies_steps(),
                   look.render.exact_integral);
    params.background = look.render.background;
    params.ambient = float(look.light.ambient);
    params.diffuse = float(look.light.diffuse);
    params.specular = float(look.light.specular);
    params.shininess = float(look.light.shininess);
    params.gradient_fade = float(scene.gradient_fade_codes(look.light));
    if (look.blend.size > 0.0) {
        params.blend_color = look.blend.color.value_or(glm::dvec3(look.render.background));
        params.blend_size = float(look.blend.size);
        params.blend_rate = float(look.blend.rate);
    }
    return params;
}

void set_ball(gpu::SurfaceParams& params, const ProbeLook& probe, const VolumeInfo& info)
{
    const glm::dvec3 origin = glm::dvec3(params.origin) + glm::dvec3(params.origin_rest);
    params.probe_center = probe.center / reference_length(info) - origin;
    params.probe_radius = float(probe.ball_share * probe.radius / reference_length(info));
    params.probe_color = probe.color;
}

gpu::PreviewParams preview_params(const ProbeLook& probe, const RayPlanes& planes)
{
    const PaintPreview& preview = *probe.preview;
    const glm::dvec3 lower(preview.box.lower);
    gpu::PreviewParams params{};
    params.near_corner = planes.near_corner - lower;
    params.near_dx = planes.near_dx;
    params.near_dy = planes.near_dy;
    params.far_corner = planes.far_corner - lower;
    params.far_dx = planes.far_dx;
    params.far_dy = planes.far_dy;
    params.size = preview.box.size();
    params.words_per_row = uint32_t(preview.words_per_row());
    params.lower = lower;
    params.color = preview_color(probe);
    params.is_striped = preview.kind == PaintPreview::Kind::erase;
    return params;
}

}  // namespace shvr

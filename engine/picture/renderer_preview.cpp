// How pictures show what a brush would change: as surfaces that rays end at, and a share of them through what hides them.

#include <algorithm>
#include <cmath>

#include "engine/passes/preview.h"
#include "engine/picture/renderer.h"

namespace shvr {

namespace {

/// Of what lies behind something else, and in slices of what is below.
constexpr float PREVIEW_SHARE = 0.55f, PREVIEW_SLICE_SHARE = 0.7f;

/// Brighter than the paint that it would become; a warning where paint would go.
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

gpu::PreviewParams preview_params(const ProbeLook& probe, const Camera& camera, const glm::uvec2& pixels,
                                  const VolumeInfo& info)
{
    const PaintPreview& preview = *probe.preview;
    const RayPlanes planes = ray_planes(camera, pixels, info);
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

}  // namespace

double ProbeLook::reach(const glm::dvec3& spacing) const
{
    const double of_shell = shell && shell->is_box ? std::sqrt(3.0) * radius : radius;
    if (!preview || preview->voxels == 0) return of_shell;
    const glm::dvec3 lower = glm::dvec3(preview->box.lower) * spacing, upper = glm::dvec3(preview->box.upper) * spacing;
    return std::max(of_shell, glm::length(glm::max(glm::abs(lower - center), glm::abs(upper - center))));
}

/// What there is of a preview comes before the rays, so that they end at it, and over the picture that they make.
Resource Renderer::cast_rays(FrameGraph& graph, VolumeBinding& volume, RaycastInput& input, const Camera& camera,
                             const PicturePart& part, Resource target)
{
    if (!part.probe || !part.probe->preview || part.probe->preview->voxels == 0)
        return raycast(graph, volume, input, target);
    const PreviewSeen made =
        preview(graph, {.params = input.params,
                        .preview = preview_params(*part.probe, camera, part.pixels, volume_->info()),
                        .words = part.probe->preview->words,
                        .surfaces = input.surfaces,
                        .slice = input.slice,
                        .group_width = input.group_width});
    input.surfaces = made.surfaces;
    const Resource picture = raycast(graph, volume, input, target);
    return preview_over(graph, made.seen, picture,
                        {.target = input.params.target,
                         .size = part.end - part.begin,
                         .share = input.slice ? PREVIEW_SLICE_SHARE : PREVIEW_SHARE});
}

}  // namespace shvr

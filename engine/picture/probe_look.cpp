#include "engine/picture/probe_look.h"

#include <algorithm>
#include <cmath>

#include "engine/volume/brick_key.h"

namespace shvr {

glm::dvec3 probe_color(const Session& session, uint8_t group)
{
    if (session.probe.color) return *session.probe.color;
    return group == 0 ? glm::dvec3(0.5) : group_of(session.groups, group).color;
}

std::optional<ProbeLook> shown_probe(const Session& session, const VolumeInfo& volume,
                                     const VolumeStatistics& statistics)
{
    const ProbeSettings& probe = session.probe;
    const bool previews = probe.preview.value_or(false);
    if (!probe.shown && !probe.shell && !previews) return std::nullopt;
    ProbeLook look{.center = probe.voxel.value_or(0.5 * glm::dvec3(volume.size)) * volume.spacing,
                   .radius = probe.brush.radius_voxels * volume.spacing.x,
                   .color = probe_color(session, probe.brush.group),
                   .ball_share = !probe.shown              ? 0.0
                                 : probe.shell || previews ? BALL_IN_SHELL
                                                           : 1.0,
                   .ball_opacity = probe.opacity};
    look.has_silhouette = probe.silhouette;
    look.has_arrow = probe.arrow;
    if (probe.shell)
        look.shell = ShellLook{
            .threshold = probe.brush.threshold.value_or(automatic_threshold(session.transfer_function, statistics)),
            .opacity = probe.shell_opacity,
            .is_box = probe.brush.region == RegionShape::box};
    return look;
}

std::optional<ProbeLook> in_picture(std::optional<ProbeLook> look, PictureProbe shown)
{
    if (look && shown == PictureProbe::point) look->ball_share = std::min(look->ball_share, BALL_IN_SHELL);
    return look;
}

double ProbeLook::reach(const glm::dvec3& spacing) const
{
    const double of_shell = shell && shell->is_box ? std::sqrt(3.0) * radius : radius;
    if (!preview || preview->voxels == 0) return of_shell;
    const glm::dvec3 lower = glm::dvec3(preview->box.lower) * spacing, upper = glm::dvec3(preview->box.upper) * spacing;
    return std::max(of_shell, glm::length(glm::max(glm::abs(lower - center), glm::abs(upper - center))));
}

std::optional<VoxelBox> voxels_of_shell(const std::optional<ProbeLook>& probe, const VolumeInfo& volume)
{
    if (!probe || !probe->shell) return std::nullopt;
    const glm::dvec3 middle = probe->center / volume.spacing, reach = probe->radius / volume.spacing;
    // Extends the box to whole bricks, so that small motions of the probe do not change which bricks are needed.
    const int64_t side = gpu::BRICK_SIZE;
    const Size3 lower = glm::max(Size3(glm::floor(middle - reach)), Size3(0)) / side;
    const Size3 upper = (Size3(glm::ceil(middle + reach)) + side - int64_t{1}) / side;
    return VoxelBox{lower * side, glm::max(upper, lower) * side};
}

}  // namespace shvr

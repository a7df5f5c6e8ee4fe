#pragma once
// How pictures show the probe: a ball, a shell around it, what its brush would change. Plain values; any thread.

#include <memory>
#include <optional>

#include "engine/annotation/work/paint_preview.h"
#include "engine/session/session.h"

namespace shvr {

/// A thin-shell iso-surface in the probe's region (shaders/library/shell.glsl).
struct ShellLook {
    double threshold = 0.0;  ///< intensity
    double opacity = 0.4;    ///< of one crossing
    bool is_box = false;     ///< the region; otherwise a ball
    bool operator==(const ShellLook&) const = default;
};

/// The probe as it is seen: a ball that rays stop at, and a shell.
struct ProbeLook {
    glm::dvec3 center{0.0};   ///< volume space
    double radius = 1.0;      ///< of its region, physical units
    glm::dvec3 color{1.0};    ///< linear light
    double ball_share = 1.0;  ///< of the radius, of the ball; 0: none
    std::optional<ShellLook> shell;
    std::shared_ptr<const PaintPreview>
        preview;  ///< what its brush would change, which slices show, too; null: not shown
    bool operator==(const ProbeLook&) const = default;
    /// Of a ball that holds all of it. `spacing`: of the volume.
    double reach(const glm::dvec3& spacing) const;
};
/// The ball beside a shell, which it must not hide.
inline constexpr double BALL_IN_SHELL = 0.12;
/// Its group's; grey where it erases.
glm::dvec3 probe_color(const Session& session, uint8_t group);
/// What pictures of a session show of its probe.
std::optional<ProbeLook> shown_probe(const Session& session, const VolumeInfo& volume,
                                     const VolumeStatistics& statistics);
/// The voxels of a volume around a probe's shell, which is seen whatever the transfer function hides; null without one.
std::optional<VoxelBox> voxels_of_shell(const std::optional<ProbeLook>& probe, const VolumeInfo& volume);

}  // namespace shvr

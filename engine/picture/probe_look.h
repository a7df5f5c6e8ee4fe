#pragma once
// Appearance of the probe in pictures: a ball, a shell around it, and the voxels that its brush would change. Plain
// values; any thread.

#include <memory>
#include <optional>

#include "engine/annotation/work/paint_preview.h"
#include "engine/session/picture_session.h"
#include "engine/session/session.h"

namespace shvr {

/// A thin-shell iso-surface in the probe's region (shaders/library/shell.glsl).
struct ShellLook {
    double threshold = 0.0;  ///< intensity
    double opacity = 0.4;    ///< opacity of one crossing of the surface
    bool is_box = false;     ///< whether the region is a box; otherwise it is a ball
    bool operator==(const ShellLook&) const = default;
};

/// The parts of the probe that are drawn: a ball, which ends rays, and a shell.
struct ProbeLook {
    glm::dvec3 center{0.0};     ///< volume space
    double radius = 1.0;        ///< radius of the probe's region, physical units
    glm::dvec3 color{1.0};      ///< linear light
    double ball_share = 1.0;    ///< radius of the ball as a share of `radius`; 0: no ball
    double ball_opacity = 1.0;  ///< opacity of the ball's surface
    std::optional<ShellLook> shell;
    std::shared_ptr<const PaintPreview>
        preview;  ///< voxels that the probe's brush would change, also shown in slices; null: not shown
    bool has_silhouette = true, has_arrow = true;  ///< whether outline and arrow may be drawn (RenderOptions)
    bool operator==(const ProbeLook&) const = default;
    /// Returns the radius of a ball that encloses all drawn parts. `spacing`: the volume's.
    double reach(const glm::dvec3& spacing) const;
};
/// Radius of the ball inside a shell, as a share of `radius`, small enough not to hide the shell.
inline constexpr double BALL_IN_SHELL = 0.12;
/// Returns the colour that the session gives the probe, or else the colour of its group; grey if the brush erases.
glm::dvec3 probe_color(const Session& session, uint8_t group);
/// Returns the probe as pictures of the session show it; null if they show none.
std::optional<ProbeLook> shown_probe(const Session& session, const VolumeInfo& volume,
                                     const VolumeStatistics& statistics);
/// Returns the probe of a picture that shows it in that way.
std::optional<ProbeLook> in_picture(std::optional<ProbeLook> look, PictureProbe shown);
/// Returns the voxels around the probe's shell, which is drawn even in hidden voxels; null if there is no shell.
std::optional<VoxelBox> voxels_of_shell(const std::optional<ProbeLook>& probe, const VolumeInfo& volume);

}  // namespace shvr

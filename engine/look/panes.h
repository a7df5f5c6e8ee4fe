#pragma once
// The views that make up a picture: a single view; one view per eye; maps that show where the camera is; or slices
// through the probe. A picture is a list of panes, each with a camera and a rectangle. Pure functions; any thread.

#include <optional>
#include <string>
#include <vector>

#include "engine/base/spelling.h"
#include "engine/look/camera_motion.h"

namespace shvr {

enum class Arrangement {
    single,
    stereo,    ///< one pane per eye, or one pane for both eyes
    overview,  ///< the camera's view, and three maps (from top, front and right) that show the camera's frustum
    slices     ///< the camera's view, and three slices through the probe, perpendicular to z, y and x
};
inline constexpr Spelling<Arrangement> ARRANGEMENTS[] = {{Arrangement::single, "single"},
                                                         {Arrangement::stereo, "stereo"},
                                                         {Arrangement::overview, "overview"},
                                                         {Arrangement::slices, "slices"}};
constexpr std::span<const Spelling<Arrangement>> spellings_of(Arrangement)
{
    return ARRANGEMENTS;
}

enum class StereoOutput { side_by_side, top_bottom, anaglyph };
inline constexpr Spelling<StereoOutput> STEREO_OUTPUTS[] = {{StereoOutput::side_by_side, "side_by_side"},
                                                            {StereoOutput::top_bottom, "top_bottom"},
                                                            {StereoOutput::anaglyph, "anaglyph"}};
constexpr std::span<const Spelling<StereoOutput>> spellings_of(StereoOutput)
{
    return STEREO_OUTPUTS;
}

struct StereoSettings {
    StereoOutput output = StereoOutput::side_by_side;
    double eye_distance = 1.0 / 30.0;  ///< distance between the eyes, as a share of the distance to the target,
                                       ///< where both eyes see the same point
    bool toe_in = false;               ///< rotates the eyes towards the target, an older method; false: off-axis
    bool operator==(const StereoSettings&) const = default;
};

struct SliceSettings {
    std::optional<double> black, white;  ///< intensities; default: the limits of the volume's range
    double paint_share = 0.5;            ///< share of the group's colour in a painted voxel's colour
    double zoom = 1.0;                   ///< zoom of all slices; 1: the whole volume fits
    std::optional<glm::dvec3> center;    ///< voxel at the centre of all slices; default: the volume's centre, or the
                                         ///< probe if zoomed in
    std::optional<glm::dvec3> cross;     ///< voxel that the slices go through; default: the probe
    bool operator==(const SliceSettings&) const = default;
};

/// Returns the voxel that the slices go through.
inline glm::dvec3 cross_of(const SliceSettings& slices, const glm::dvec3& probe_voxel)
{
    return slices.cross.value_or(probe_voxel);
}

struct ViewSettings {
    Arrangement arrangement = Arrangement::single;
    StereoSettings stereo;
    SliceSettings slices;
    double overview_zoom = 1.0;
    bool volume = true;           ///< whether voxels are shown outside of slices
    bool meshes = true;           ///< the trace, surfaces and the probe's ball
    bool cut_box = false;         ///< draws the edges of the box that remains after cutting
    std::optional<uint8_t> solo;  ///< if set, only this group and its descendants are drawn; 0: only unpainted voxels
    bool plane_handles = true;    ///< the window draws handles for the oblique cutting plane, where there is one
    bool operator==(const ViewSettings&) const = default;
};

/// The contents of a pane.
struct Shot {
    Shot(const Camera& seen_from) : camera(seen_from) {}  // implicit, because a camera alone makes a complete shot
    Camera camera;
    std::optional<Camera> right_eye;  ///< for anaglyphs: `camera` gives red, `right_eye` gives green and blue
    bool is_slice = false;            ///< draws only the plane half-way between the clip planes, unshaded, in grey
    bool operator==(const Shot&) const = default;
};

struct Pane {
    enum class Kind { main, left_eye, right_eye, map, slice };
    Kind kind = Kind::main;
    Shot shot;
    PixelBox box;      ///< the pixels of the picture that the pane covers
    std::string name;  ///< "top", "slice across z", ...
    int axis = -1;     ///< the axis perpendicular to the slice; -1 for panes of other kinds
    glm::uvec2 pixels() const { return box.end - box.begin; }
};

/// Returns the panes of a picture; the first is the view of `main`. If the division leaves a remainder, a row or column
/// of pixels stays uncovered. Slices go through cross_of(). A picture too small to divide has one pane.
std::vector<Pane> panes_of(const ViewSettings& settings, const Camera& main, const glm::uvec2& pixels,
                           const VolumeInfo& volume, const glm::dvec3& probe_voxel);

/// Zooms all slices by `factor` about the point at a pixel of one slice, which stays at that pixel. Zooming out ends
/// when the whole volume fits; the volume is then centred.
SliceSettings slices_zoomed(const SliceSettings& slices, const Pane& slice, const glm::dvec2& pixel, double factor,
                            const VolumeInfo& volume, const glm::dvec3& probe_voxel);
/// Moves the centre of all slices, so that `slice` follows a mouse motion of `way` pixels.
SliceSettings slices_moved(const SliceSettings& slices, const Pane& slice, const glm::dvec2& way,
                           const VolumeInfo& volume, const glm::dvec3& probe_voxel);
/// Moves the slices along an axis if the cross has left the visible part of a slice along this axis. `held` is the
/// index of the pane under the mouse, whose slice does not move while the cross is visible in it.
SliceSettings slices_following(const SliceSettings& slices, const std::vector<Pane>& panes, std::optional<size_t> held,
                               const VolumeInfo& volume, const glm::dvec3& probe_voxel);

/// Returns the cameras of the left and the right eye. With off-axis cameras, both eyes see a point at the target's
/// depth at the same pixel, and there is no vertical parallax. With `toe_in`, and for orthographic cameras, the eyes
/// rotate about the target instead (without rotation, orthographic cameras have no parallax).
std::pair<Camera, Camera> eyes_of(const Camera& camera, const StereoSettings& settings);

}  // namespace shvr

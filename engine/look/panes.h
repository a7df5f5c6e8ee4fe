#pragma once
// The views that make up a picture: a single one; two for two eyes; maps that show where the camera is; or slices
// through the probe. A picture is a list of panes; each pane is a camera and a rectangle. Pure; any thread.

#include <optional>
#include <string>
#include <vector>

#include "engine/base/spelling.h"
#include "engine/look/camera_motion.h"

namespace shvr {

enum class Arrangement {
    single,
    stereo,    ///< a pane for each eye, or both in one
    overview,  ///< the camera's view, and the volume from the top, the front and the right, with the camera's frustum
    slices     ///< the camera's view, and the planes through the probe across z, y and x
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
    double eye_distance = 1.0 / 30.0;  ///< distance between the eyes, as a share of that to the target, where both eyes
                                       ///< see the same point
    bool toe_in = false;               ///< rotates the eyes towards the target, an older method; false: off-axis
    bool operator==(const StereoSettings&) const = default;
};

struct SliceSettings {
    std::optional<double> black, white;  ///< intensities; default: the ends of the volume's range
    double paint_share = 0.5;            ///< share of a painted voxel's colour that comes from its group
    double zoom = 1.0;                   ///< zoom of the slices; 1: the whole volume fits
    std::optional<glm::dvec3> center;    ///< voxel at their centre; default: the volume's centre, or the probe if
                                         ///< zoomed in
    bool operator==(const SliceSettings&) const = default;
};

struct ViewSettings {
    Arrangement arrangement = Arrangement::single;
    StereoSettings stereo;
    SliceSettings slices;
    double overview_zoom = 1.0;
    bool volume = true;           ///< false: voxels are shown only in slices
    bool meshes = true;           ///< a trace, surfaces and the probe's ball
    bool cut_box = false;         ///< draws the edges of the box that the cutting planes keep
    std::optional<uint8_t> solo;  ///< draws only this group and its descendants; 0: only unpainted voxels
    bool operator==(const ViewSettings&) const = default;
};

/// The contents of a pane.
struct Shot {
    Shot(const Camera& seen_from) : camera(seen_from) {}  // implicit: a camera is a shot
    Camera camera;
    std::optional<Camera> right_eye;  ///< for an anaglyph: `camera` gives red, this one green and blue
    bool is_slice = false;            ///< draws the voxels half-way between the camera's clip planes unshaded, in grey
    bool operator==(const Shot&) const = default;
};

struct Pane {
    enum class Kind { main, left_eye, right_eye, map, slice };
    Kind kind = Kind::main;
    Shot shot;
    PixelBox box;      ///< axis perpendicular to the slice; -1 if this is no slice
    std::string name;  ///< "top", "slice across z", ...
    int axis = -1;     ///< slices: the axis perpendicular to it
    glm::uvec2 pixels() const { return box.end - box.begin; }
};

/// The panes of a picture; the first is the view of `main`. They cover the picture, except for a row or column if it
/// does not divide evenly. `probe_voxel`: the point that slices go through. A picture too small to divide has one pane.
std::vector<Pane> panes_of(const ViewSettings& settings, const Camera& main, const glm::uvec2& pixels,
                           const VolumeInfo& volume, const glm::dvec3& probe_voxel);

/// Zooms slices by `factor` about the point at a pixel of one of them, which stays fixed. Zooming out stops at the
/// whole volume, which is then centred.
SliceSettings slices_zoomed(const SliceSettings& slices, const Pane& slice, const glm::dvec2& pixel, double factor,
                            const VolumeInfo& volume, const glm::dvec3& probe_voxel);
/// Moves slices so that one of them follows a mouse motion of `way` pixels.
SliceSettings slices_moved(const SliceSettings& slices, const Pane& slice, const glm::dvec2& way,
                           const VolumeInfo& volume, const glm::dvec3& probe_voxel);
/// Moves slices along the axes along which the probe is outside one of them. `held`: index of the pane under the mouse,
/// which does not move as long as the probe is visible in it.
SliceSettings slices_following(const SliceSettings& slices, const std::vector<Pane>& panes, std::optional<size_t> held,
                               const VolumeInfo& volume, const glm::dvec3& probe_voxel);

/// The cameras of two eyes, left and right. Off-axis, both see a point at the target's depth at the same pixel, and
/// there is no vertical parallax. With `toe_in`, and for orthographic cameras, which have no other parallax, the eyes
/// rotate about the target instead.
std::pair<Camera, Camera> eyes_of(const Camera& camera, const StereoSettings& settings);

}  // namespace shvr

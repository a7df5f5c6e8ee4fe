#pragma once
// Which views a picture is made of: one, two for two eyes, a map of where the camera is, or slices through the probe. A
// picture is a list of panes; each pane is a camera and a rectangle. Pure; any thread.

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
    double eye_distance = 1.0 / 30.0;  ///< in distances from eye to target, where both eyes see the same
    bool toe_in = false;               ///< eyes turned towards the target, as long ago; otherwise off-axis
    bool operator==(const StereoSettings&) const = default;
};

struct SliceSettings {
    std::optional<double> black, white;  ///< intensities; the ends of the volume's range
    double paint_share = 0.5;            ///< how much of a painted voxel's colour is its group's
    double zoom = 1.0;                   ///< of the slices; 1: the whole volume fits
    bool operator==(const SliceSettings&) const = default;
};

struct ViewSettings {
    Arrangement arrangement = Arrangement::single;
    StereoSettings stereo;
    SliceSettings slices;
    double overview_zoom = 1.0;
    bool operator==(const ViewSettings&) const = default;
};

/// What is seen in a pane.
struct Shot {
    Shot(const Camera& seen_from) : camera(seen_from) {}  // a camera is a shot
    Camera camera;
    std::optional<Camera> right_eye;  ///< an anaglyph: `camera` gives red, this one green and blue
    bool is_slice = false;  ///< half-way between the camera's clip planes the voxels are drawn as they are, grey
    bool operator==(const Shot&) const = default;
};

struct Pane {
    enum class Kind { main, left_eye, right_eye, map, slice };
    Kind kind = Kind::main;
    Shot shot;
    PixelBox box;      ///< of the whole picture
    std::string name;  ///< "top", "slice across z", ...
    int axis = -1;     ///< of a slice: what it lies across
    glm::uvec2 pixels() const { return box.end - box.begin; }
};

/// The panes of a picture, the one that `main` sees first. They cover the picture, but for a row or column where it
/// does not divide. `probe_voxel`: what slices go through. A picture that is too small to be divided has one pane.
std::vector<Pane> panes_of(const ViewSettings& settings, const Camera& main, const glm::uvec2& pixels,
                           const VolumeInfo& volume, const glm::dvec3& probe_voxel);

/// The cameras of two eyes, left and right. Off-axis, a point at the target's depth is seen at the same pixel by both
/// and nothing is seen higher by one than by the other; with `toe_in`, and for orthographic cameras, which have no
/// other parallax, the eyes turn about the target instead.
std::pair<Camera, Camera> eyes_of(const Camera& camera, const StereoSettings& settings);

}  // namespace shvr

#pragma once
// A picture's frame: everything that is added to a graph to draw a part of a picture, in order. What is in brackets is
// there only where there is something to do.
//
//   volume     [brick_leap, upload page directory] clear reached, of paged bricks      | which bricks, how far rays go
//              [leap_occupancy -> leap_distance x, y, z; or leap_bound, leap_occupancy] | of a resident volume
//   occlusion  [start occlusion -> reset occlusion values, clear occlusion cells]
//   tables     [upload transfer function] [upload groups]
//   surfaces   [upload surface nodes, upload surface list] [surfaces]                  (a trace, the probe's ball)
//   preview    [preview]                                                               (what a brush would change)
//   rays       raycast, one thread a pixel
//   preview    [preview_over]
//   anaglyph   the last four for each eye, then anaglyph
//
// Beside pictures: next_preparation and next_refinement (the leap grid's stages, one at a time) and next_occlusion
// (occlusion_cells, occlusion_gather, occlusion_bake). One thread, the one that owns the device.

#include <optional>

#include "engine/device/scene.h"
#include "engine/look/look.h"
#include "engine/picture/probe_look.h"

namespace shvr {

/// A rectangle of a picture, and where it goes.
struct PicturePart {
    glm::uvec2 pixels{0};         ///< of the whole picture
    glm::uvec2 begin{0}, end{0};  ///< the pixels that are drawn
    glm::uvec2 target{0};         ///< texel that `begin` goes to
    glm::uvec2 detail_pixels{0};  ///< of the picture that decides how fine the bricks are; 0: this one
    std::optional<ProbeLook> probe{};
    /// Paged bricks of these voxels are among those that the view needs, whatever the transfer function hides: for a
    /// shell, which may lie where nothing else is seen (voxels_of_shell). Equal for all parts of a view.
    std::optional<VoxelBox> always_shown{};
};

/// What was added to a graph: the target's new version, and what the volume takes back once the graph is done.
struct Drawn {
    Resource target;
    DeviceVolume::Feedback feedback;
};
/// Adds the passes that draw a part of what `shot` sees into `target`, an rgba32_float image: linear light,
/// premultiplied, over the background. The graph must be submitted, and before any other that was made later.
Drawn draw(FrameGraph& graph, Scene& scene, const Look& look, const Shot& shot, const PicturePart& part,
           Resource target, bool count_work = false);
/// Adds the passes that find what is seen at one pixel: position and 1, or 0, in the one texel of an image.
Resource pick(FrameGraph& graph, Scene& scene, const Look& look, const Shot& shot, const PicturePart& part);

/// Tells the volume what is looked at, as draw() does. Returns the distance between samples in reference lengths:
/// samples of coarse bricks may lie farther apart.
double look_at(Scene& scene, const Look& look, const Shot& shot, const PicturePart& part);

/// What has to be computed before parts of this look are drawn, one short graph at a time; nothing when all is ready.
/// Callers that do not ask get it all in the first draw(). The graph must be submitted before the next call.
std::optional<FrameGraph> next_preparation(Scene& scene, const Look& look);
/// What makes pictures of it come sooner without making them different, for when nothing else is to be done; likewise.
std::optional<FrameGraph> next_refinement(Scene& scene, const Look& look);
/// The next slice of the ambient occlusion that the look wants, nearest to the camera; nothing where it wants none or
/// all is made. Likewise. Pictures are drawn with what is made so far.
std::optional<FrameGraph> next_occlusion(Scene& scene, const Look& look, const Camera& camera,
                                         const Occlusion::Most& most);

}  // namespace shvr

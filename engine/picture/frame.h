#pragma once
// A picture's frame: every pass that is added to a graph to draw a part of a picture, in order. Passes in brackets are
// added only where there is work for them.
//
//   volume     [brick_leap, upload page directory] clear reached, of paged bricks      | which bricks, how far rays go
//              [leap_occupancy -> leap_distance x, y, z; or leap_bound, leap_occupancy] | of a resident volume
//   occlusion  [start occlusion -> reset occlusion values, clear occlusion cells]
//   tables     [upload transfer function] [upload groups]
//   surfaces   [upload surface nodes, upload surface list] [surface_tiles] [surfaces]  (a trace, the probe's ball)
//   preview    [preview]                                                               (what a brush would change)
//   adaptive   [surfaces, preview and raycast of a coarse picture, clear blocks, clear groups, adaptive]
//   rays       raycast, one thread a pixel, or of the blocks that adaptive has listed
//   preview    [preview_over]
//   ball       [the last four without the probe's ball, then mix]                      (a translucent one)
//   colours    [saturation]
//   anaglyph   the last five for each eye, then anaglyph
//
// Beside pictures: next_preparation and next_refinement (the leap grid's stages, one at a time) and next_occlusion
// (occlusion_cells, occlusion_gather, occlusion_bake). One thread, the one that owns the device.

#include <optional>
#include <string>
#include <vector>

#include "engine/device/scene.h"
#include "engine/look/look.h"
#include "engine/passes/raycast.h"
#include "engine/picture/probe_look.h"

namespace shvr {

/// A rectangle of a picture, and where it is drawn.
struct PicturePart {
    glm::uvec2 pixels{0};         ///< of the whole picture
    glm::uvec2 begin{0}, end{0};  ///< the pixels that are drawn
    glm::uvec2 target{0};         ///< texel that `begin` is drawn to
    glm::uvec2 detail_pixels{0};  ///< size of the picture that sets the bricks' level of detail; 0: this one
    std::optional<ProbeLook> probe{};
    /// The view always needs the paged bricks of these voxels, whatever the transfer function hides: a shell may lie
    /// where nothing else is visible (voxels_of_shell). Equal for all parts of a view.
    std::optional<VoxelBox> always_shown{};
};

/// What rays have gathered that wait for bricks, from one graph to the next (engine/passes/raycast.h, RaysInWaiting).
class WaitingRays {
public:
    /// Bytes on the device for a pixel of each picture.
    static constexpr uint64_t PIXEL_BYTES = 2 * 4 * sizeof(float);
    /// `pixels`: of the part that is drawn; `pictures`: pictures_of it. Fails where the budget does not hold them.
    WaitingRays(gpu::Memory& memory, const glm::uvec2& pixels, int pictures);
    RaysInWaiting import(FrameGraph& graph, size_t picture) const;
    void have_begun() { have_begun_ = true; }

private:
    std::vector<gpu::Storage> pictures_;
    bool have_begun_ = false;
};

/// Pictures that are followed by rays: of each eye, and of each with and without a translucent ball of the probe.
int pictures_of(const Shot& shot, const std::optional<ProbeLook>& probe);

/// What was added to a graph: the target's new version, and the feedback to hand to the volume when the graph is done.
struct Drawn {
    Resource target;
    DeviceVolume::Feedback feedback;
};
/// Adds the passes that draw a part of what `shot` sees into `target`, an rgba32_float picture: linear light,
/// premultiplied, over the background. The graph must be submitted before any graph made later. `waiting`: rays go on
/// where they waited for bricks in the graph before; it is the same part, and the volume lets rays wait. Null: the
/// volume lets none wait any more.
Drawn draw(FrameGraph& graph, Scene& scene, const Look& look, const Shot& shot, const PicturePart& part,
           Resource target, bool count_work = false, WaitingRays* waiting = nullptr);
/// What all parts of a shot need before their rays are followed, whatever their size: tables, directory, surfaces. The
/// graph must be submitted before any graph made later. Parts are drawn without it as well.
FrameGraph prepared(Scene& scene, const Look& look, const Shot& shot, const PicturePart& part);
/// Adds the passes that find what is visible at one pixel: an image of one texel, with the position and 1, or 0.
Resource pick(FrameGraph& graph, Scene& scene, const Look& look, const Shot& shot, const PicturePart& part);

/// Rays that stopped before their end, though nothing opaque ended them, in what was drawn. What they show is wrong.
uint64_t rays_cut_short(const std::vector<gpu::PassReport>& passes);
/// That, in a sentence.
std::string cut_short_sentence(uint64_t rays, const Look& look);

/// Whether draw() of a part, or look_at(), would not wait until the bricks of the view are listed. If not, that begins:
/// ask again.
bool get_ready(Scene& scene, const Look& look, const Shot& shot, const PicturePart& part);
/// Sets the volume's view, as draw() does. Returns the distance between samples in reference lengths: samples of coarse
/// bricks may be farther apart.
double look_at(Scene& scene, const Look& look, const Shot& shot, const PicturePart& part);

/// Work to do before parts of this look can be drawn, one short graph at a time; null when all is ready. Without these
/// calls the first draw() does it all. The graph must be submitted before the next call.
std::optional<FrameGraph> next_preparation(Scene& scene, const Look& look);
/// Likewise, for idle time: work that makes later pictures faster without changing them.
std::optional<FrameGraph> next_refinement(Scene& scene, const Look& look);
/// Likewise, the next slice of the look's ambient occlusion, nearest to the camera first; null where the look wants
/// none or all is done. Pictures are drawn with what there is so far.
std::optional<FrameGraph> next_occlusion(Scene& scene, const Look& look, const Camera& camera,
                                         const Occlusion::Most& most);

}  // namespace shvr

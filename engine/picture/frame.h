#pragma once
// The passes that draw a part of a picture, in the order in which they are added to a graph. Passes in brackets are
// added only if there is work for them.
//
//   volume     [brick_leap, upload page directory] clear reached       (paged volume: which bricks, how far rays go)
//              [leap_occupancy -> leap_distance x, y, z; or leap_bound, leap_occupancy] [sample_bits] (resident volume)
//   occlusion  [start occlusion -> reset occlusion values, clear occlusion cells]
//   tables     [upload transfer function] [upload groups] [upload surface nodes, upload surface list]
//   surfaces   [surface_tiles] [surfaces]                              (a trace, the probe's ball)
//              the same before it for meshes, then [nearer]
//   preview    [preview]                                               (what a brush would change)
//   rays       raycast, one thread per pixel
//   preview    [preview_over]
//   ball       [surfaces to preview_over again, without the probe's ball, then mix]    (if it is translucent)
//   colours    [saturation]
//   anaglyph   [surfaces to colours once per eye, then anaglyph]
//
// Passes that are not part of a picture come from next_preparation and next_refinement (stages of the leap grid, one at
// a time) and next_occlusion (occlusion_cells, occlusion_gather, occlusion_bake). Only on the device's thread.

#include <optional>
#include <string>
#include <vector>

#include "engine/device/scene.h"
#include "engine/look/look.h"
#include "engine/passes/raycast.h"
#include "engine/picture/probe_look.h"

namespace shvr {

/// A rectangle of a picture, and the texel of the target image at which it is drawn.
struct PicturePart {
    glm::uvec2 pixels{0};         ///< size of the whole picture
    glm::uvec2 begin{0}, end{0};  ///< the pixels that are drawn
    glm::uvec2 target{0};         ///< texel that `begin` is drawn to
    glm::uvec2 detail_pixels{0};  ///< picture size that determines the bricks' level of detail; 0: `pixels`
    std::optional<ProbeLook> probe{};
    /// A box whose paged bricks the view always needs, even if the transfer function hides their voxels: the probe's
    /// shell may be drawn where nothing else is visible (voxels_of_shell). The box is the same for all parts of a view.
    std::optional<VoxelBox> always_shown{};
};

/// State of each pixel's ray that waits for bricks, kept from one graph to the next (engine/passes/raycast.h,
/// RaysInWaiting).
class WaitingRays {
public:
    /// Device bytes per pixel and picture.
    static constexpr uint64_t PIXEL_BYTES = 2 * 4 * sizeof(float);
    /// `pixels`: size of the drawn part. `pictures`: result of pictures_of(). Fails if the budget is too small.
    WaitingRays(gpu::Memory& memory, const glm::uvec2& pixels, int pictures);
    RaysInWaiting import(FrameGraph& graph, size_t picture) const;
    void have_begun() { have_begun_ = true; }

private:
    std::vector<gpu::Storage> pictures_;
    bool have_begun_ = false;
};

/// Number of ray-cast pictures per shot: one per eye; twice as many with a translucent ball of the probe.
int pictures_of(const Shot& shot, const std::optional<ProbeLook>& probe);

/// Result of adding a part's passes to a graph: the target's new version, and feedback about visited bricks, which the
/// volume receives once the graph has run.
struct Drawn {
    Resource target;
    DeviceVolume::Feedback feedback;
};
/// Adds the passes that draw a part of a shot into `target`, an rgba32_float picture: linear light, premultiplied, over
/// the background. The graph must be submitted before any graph made later. `waiting`: rays continue at the missing
/// bricks at which they stopped in the previous graph; this requires the same part, and a volume that lets rays wait.
/// If `waiting` is null, the volume is switched to rays that do not wait.
Drawn draw(FrameGraph& graph, Scene& scene, const Look& look, const Shot& shot, const PicturePart& part,
           Resource target, bool count_work = false, WaitingRays* waiting = nullptr);
/// Returns a graph of the preparation that all parts of a shot share, whatever their size: tables, directory, surfaces.
/// Submit it before any graph made later. Calling this function is optional: draw() prepares what is missing.
FrameGraph prepared(Scene& scene, const Look& look, const Shot& shot, const PicturePart& part);
/// Adds the passes that find the visible point at one pixel. Returns a one-texel image: the point's position and 1, or
/// 0 if no point is visible.
Resource pick(FrameGraph& graph, Scene& scene, const Look& look, const Shot& shot, const PicturePart& part);

/// Number of drawn rays that stopped too early: before their end, and not at anything opaque. Their pixels are wrong.
uint64_t rays_cut_short(const std::vector<gpu::PassReport>& passes);
/// Returns the sentence that warns the user about rays that stopped early.
std::string cut_short_sentence(uint64_t rays, const Look& look);

/// Returns whether draw() and look_at() could run without waiting for the list of bricks that the view needs. If they
/// could not, starts making the list in the background; call again later.
bool get_ready(Scene& scene, const Look& look, const Shot& shot, const PicturePart& part);
/// Sets the volume's view, as draw() does. Returns the distance between samples, in reference lengths; the distance is
/// larger if the view uses coarse bricks.
double look_at(Scene& scene, const Look& look, const Shot& shot, const PicturePart& part);

/// Returns one short graph of work that must precede drawing parts of this look; null if none is left. Submit the graph
/// before the next call. Calling this function is optional: the first draw() does all work that is left.
std::optional<FrameGraph> next_preparation(Scene& scene, const Look& look);
/// Like next_preparation(), for idle time: returns work that makes later pictures faster without changing them.
std::optional<FrameGraph> next_refinement(Scene& scene, const Look& look);
/// Like next_preparation(), but returns the next slice of the look's ambient occlusion, nearest to the camera first;
/// null if the look has no occlusion or all of it is computed. Pictures use the occlusion computed so far.
std::optional<FrameGraph> next_occlusion(Scene& scene, const Look& look, const Camera& camera,
                                         const Occlusion::Most& most);

}  // namespace shvr

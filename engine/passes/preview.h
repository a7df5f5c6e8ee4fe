#pragma once
// Draws the voxels that a brush would change (shaders/preview.comp).

#include <optional>
#include <span>

#include "engine/graph/frame_graph.h"
#include "engine/passes/pixel_groups.h"
#include "shaders/preview.h"
#include "shaders/raycast.h"

namespace shvr {

struct PreviewInput {
    gpu::RaycastParams params;  ///< the ray caster's parameters: only pixels, light and distance blending are used
    gpu::PreviewParams preview;
    std::span<const uint32_t> words;   ///< one bit per voxel, in rows of params.words_per_row
    std::optional<Resource> surfaces;  ///< surfaces for the same pixels; not used in slices
    bool slice = false;
    PixelGroups pixel_groups;
};

struct PreviewSeen {
    std::optional<Resource> surfaces;  ///< the ray caster's surfaces combined with the preview; null in slices
    Resource seen;                     ///< for `preview_over`
};
/// All resources of the result are transient, so they are valid in this frame only.
PreviewSeen preview(FrameGraph& graph, const PreviewInput& input);

/// Hints that a preview is likely to be drawn soon.
void expect_preview(FrameGraph& graph, const PreviewInput& input);

/// Draws the preview over the picture in `target`, which the ray caster has drawn with PreviewSeen::surfaces. Returns
/// the new version of `target`.
Resource preview_over(FrameGraph& graph, Resource seen, Resource target, const gpu::PreviewOverParams& params);

}  // namespace shvr

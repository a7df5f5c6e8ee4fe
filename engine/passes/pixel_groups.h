#pragma once
// Dispatch sizes for passes with workgroups of 8 x 8 threads. Any thread.

#include "engine/graph/frame_graph.h"

namespace shvr {

inline constexpr uint32_t GROUP_SIDE = 8;  ///< threads, as the kernels declare

/// How workgroups divide the pixels of a picture (shaders/library/rays.glsl).
struct PixelGroups {
    uint32_t width = 8;  ///< pixels along x that a workgroup covers: 8, 16 or 32
    /// Number of layers of workgroups along z in a dispatch, interleaved by rows: layer i has every `layers`th row,
    /// starting at row i. Interleaved layers take nearly the same time; the upper and lower halves of a picture do not.
    /// Divides the number of rows of a tile.
    uint32_t layers = 1;
    glm::uvec2 tile{0};  ///< size in pixels of one dispatch, multiples of 64; 0: one dispatch for all
};

/// Dispatches one thread per pixel.
inline void pixel_groups(Pass& pass, const glm::uvec2& pixels, const PixelGroups& groups)
{
    const glm::uvec2 group(groups.width, GROUP_SIDE * GROUP_SIDE / groups.width);
    const glm::uvec2 all = (pixels + group - 1u) / group;
    uint32_t layers = groups.layers;  // reduced until at most an eighth of the layers' rows have no pixels
    while (layers > 1 && 8 * ((all.y + layers - 1) / layers * layers - all.y) > all.y) layers /= 2;
    const auto threads = [&](const glm::uvec2& count) {
        return glm::uvec3(GROUP_SIDE * count.x, GROUP_SIDE * ((count.y + layers - 1) / layers), layers);
    };
    pass.dispatch(threads(all), groups.tile.x > 0 ? threads(groups.tile / group) : glm::uvec3(0));
}

/// Dispatches one workgroup per job, or `depth` workgroups that share a job's work.
inline void group_each(Pass& pass, size_t count, uint32_t depth = 1)
{
    pass.dispatch({GROUP_SIDE * uint32_t(count), GROUP_SIDE, depth});
}

}  // namespace shvr

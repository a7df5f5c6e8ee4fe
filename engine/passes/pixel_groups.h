#pragma once
// Dispatch sizes for passes whose kernels have workgroups of 8 x 8. Any thread.

#include "engine/graph/frame_graph.h"

namespace shvr {

inline constexpr uint32_t GROUP_SIDE = 8;  ///< threads, as the kernels declare

/// One thread per pixel, in groups (GROUP_WIDTH) `group_width` pixels wide. `tile`: pixels of one dispatch, multiples
/// of the groups; 0: all at once.
inline void pixel_groups(Pass& pass, const glm::uvec2& pixels, uint32_t group_width,
                         const glm::uvec2& tile = glm::uvec2(0))
{
    const glm::uvec2 group(group_width, GROUP_SIDE * GROUP_SIDE / group_width);
    pass.dispatch(glm::uvec3((pixels + group - 1u) / group * GROUP_SIDE, 1),
                  glm::uvec3(tile / group * GROUP_SIDE, tile.x > 0));
}

/// One workgroup for each of `count` jobs, or `depth` of them where they share a job's work.
inline void group_each(Pass& pass, size_t count, uint32_t depth = 1)
{
    pass.dispatch({GROUP_SIDE * uint32_t(count), GROUP_SIDE, depth});
}

}  // namespace shvr

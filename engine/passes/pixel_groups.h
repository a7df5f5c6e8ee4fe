#pragma once
// How many threads a pass takes whose kernel has workgroups of 8 x 8. Any thread.

#include "engine/graph/frame_graph.h"

namespace shvr {

inline constexpr uint32_t GROUP_SIDE = 8;  ///< threads, as the kernels declare

/// A thread for each of `pixels`, in groups (GROUP_WIDTH) `group_width` pixels wide. `tile`: pixels of one dispatch,
/// multiples of the groups; 0: all at once.
inline void pixel_groups(Pass& pass, const glm::uvec2& pixels, uint32_t group_width,
                         const glm::uvec2& tile = glm::uvec2(0))
{
    const glm::uvec2 group(group_width, GROUP_SIDE * GROUP_SIDE / group_width);
    pass.dispatch(glm::uvec3((pixels + group - 1u) / group * GROUP_SIDE, 1),
                  glm::uvec3(tile / group * GROUP_SIDE, tile.x > 0));
}

/// A workgroup for each of `count` jobs, and `depth` of them where they share its work.
inline void group_each(Pass& pass, size_t count, uint32_t depth = 1)
{
    pass.dispatch({GROUP_SIDE * uint32_t(count), GROUP_SIDE, depth});
}

}  // namespace shvr

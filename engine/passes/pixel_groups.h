#pragma once
// One thread a pixel, for kernels of 8 x 8 threads whose groups may cover pixels of another shape (GROUP_WIDTH). Any
// thread.

#include "engine/graph/frame_graph.h"

namespace shvr {

inline constexpr uint32_t PIXEL_GROUP_SIDE = 8;  ///< threads, as the kernels declare

/// Dispatches a thread for each of `pixels`, in groups `group_width` pixels wide. `tile`: pixels of one dispatch,
/// multiples of the groups; 0: all at once.
inline void pixel_groups(Pass& pass, const glm::uvec2& pixels, uint32_t group_width,
                         const glm::uvec2& tile = glm::uvec2(0))
{
    const glm::uvec2 group(group_width, PIXEL_GROUP_SIDE * PIXEL_GROUP_SIDE / group_width);
    pass.dispatch(glm::uvec3((pixels + group - 1u) / group * PIXEL_GROUP_SIDE, 1),
                  glm::uvec3(tile / group * PIXEL_GROUP_SIDE, tile.x > 0));
}

}  // namespace shvr

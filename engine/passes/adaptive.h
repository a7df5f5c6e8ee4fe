#pragma once
// Pictures whose rays are closer where there is more to see (shaders/adaptive.h).

#include <optional>

#include "engine/graph/frame_graph.h"
#include "engine/passes/pixel_groups.h"
#include "shaders/adaptive.h"

namespace shvr {

/// Blocks of pixels that are drawn, and no others.
struct ListedBlocks {
    Resource numbers;  ///< of blocks, in a buffer, gpu::NO_BLOCK beyond the last
    Resource counts;   ///< of workgroups, as Pass::dispatch_counted takes them
    uint32_t most_groups = 0;
    uint32_t groups_in_dispatch = 0;
};

struct AdaptiveInput {
    glm::uvec2 pixel_begin{0}, pixel_end{0};  ///< the part of the picture
    glm::uvec2 target{0};                     ///< texel of its first pixel
    double tolerance = 0.0;
    PixelGroups pixel_groups;  ///< of the passes that draw the blocks
};

/// Pixels of the coarse picture that a part needs: coarse_begin, and so many from there.
glm::uvec2 coarse_begin(const AdaptiveInput& input);
glm::uvec2 coarse_size(const AdaptiveInput& input);

struct Adapted {
    Resource target;
    ListedBlocks blocks;
};
/// Draws the pixels of `target` that lie between alike ones of `coarse`, and lists the blocks of all others. Both are
/// rgba32_float pictures; `coarse` has pixel coarse_begin() in its first texel.
Adapted adaptive(FrameGraph& graph, Resource coarse, Resource target, const AdaptiveInput& input);

/// Blocks of 4 x 2 pixels take so many bytes on the device, for each pixel.
inline constexpr uint64_t LISTED_BLOCKS_BYTES = 1;

/// For kernels that include library/listed_blocks.glsl: what their constant BLOCKS_ALONE says, and how many groups they
/// have if it is 1.
void listed_groups(Pass& pass, const std::optional<ListedBlocks>& blocks);

}  // namespace shvr

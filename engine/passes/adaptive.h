#pragma once
// Pictures with denser rays where there is more detail (shaders/adaptive.h).

#include <optional>

#include "engine/graph/frame_graph.h"
#include "engine/passes/pixel_groups.h"
#include "shaders/adaptive.h"

namespace shvr {

/// Blocks of pixels to which drawing is limited.
struct ListedBlocks {
    Resource numbers;  ///< numbers of blocks, in a buffer; gpu::NO_BLOCK after the last one
    Resource counts;   ///< workgroup counts, as Pass::dispatch_counted takes them
    uint32_t most_groups = 0;
    uint32_t groups_in_dispatch = 0;
};

struct AdaptiveInput {
    glm::uvec2 pixel_begin{0}, pixel_end{0};  ///< the part of the picture
    glm::uvec2 target{0};                     ///< texel of the part's first pixel
    double tolerance = 0.0;
    PixelGroups pixel_groups;  ///< workgroup layout of the passes that draw the blocks
};

/// The coarse picture's pixels that a part needs: the first one, and their number along each axis.
glm::uvec2 coarse_begin(const AdaptiveInput& input);
glm::uvec2 coarse_size(const AdaptiveInput& input);

struct Adapted {
    Resource target;
    ListedBlocks blocks;
};
/// Fills in the pixels of `target` that lie between similar ones of `coarse`, and lists the blocks of all others. Both
/// are rgba32_float pictures; the first texel of `coarse` is pixel coarse_begin().
Adapted adaptive(FrameGraph& graph, Resource coarse, Resource target, const AdaptiveInput& input);

/// Device bytes of the lists of 4 x 2 pixel blocks, per pixel.
inline constexpr uint64_t LISTED_BLOCKS_BYTES = 1;

/// For kernels that include library/listed_blocks.glsl: sets their constant BLOCKS_ALONE and, if it is 1, the number of
/// their groups.
void listed_groups(Pass& pass, const std::optional<ListedBlocks>& blocks);

}  // namespace shvr

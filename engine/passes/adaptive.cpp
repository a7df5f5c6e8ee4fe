#include "engine/passes/adaptive.h"

#include <algorithm>

namespace shvr {

namespace {

constexpr uint32_t GROUP_THREADS = GROUP_SIDE * GROUP_SIDE;

glm::uvec2 blocks_of(const AdaptiveInput& input)
{
    return gpu::adaptive_blocks(input.pixel_begin, input.pixel_end);
}

}  // namespace

glm::uvec2 coarse_begin(const AdaptiveInput& input)
{
    return gpu::adaptive_begin(input.pixel_begin) / 2u;
}

glm::uvec2 coarse_size(const AdaptiveInput& input)
{
    return glm::uvec2(gpu::ADAPTIVE_BLOCK_X, gpu::ADAPTIVE_BLOCK_Y) / 2u * blocks_of(input) + 1u;
}

Adapted adaptive(FrameGraph& graph, Resource coarse, Resource target, const AdaptiveInput& input)
{
    const glm::uvec2 blocks = blocks_of(input), tile = input.pixel_groups.tile;
    const uint32_t in_group = gpu::ADAPTIVE_BLOCKS_IN_GROUP, groups = (blocks.x * blocks.y + in_group - 1) / in_group;
    const uint32_t in_dispatch = tile.x > 0 ? std::min(groups, tile.x * tile.y / GROUP_THREADS) : groups;
    const uint32_t dispatches = (groups + in_dispatch - 1) / in_dispatch;
    const Resource numbers = graph.fill(graph.create("listed blocks", buffer_desc(uint64_t{4} * groups * in_group)),
                                        gpu::NO_BLOCK, "clear blocks");
    const Resource counts = graph.fill(
        graph.create("groups of listed blocks", buffer_desc(uint64_t{4} * (3 * dispatches + 1))), 0, "clear groups");
    Pass pass = graph.compute("adaptive");
    pass.push(gpu::AdaptiveParams{.pixel_begin = input.pixel_begin,
                                  .pixel_end = input.pixel_end,
                                  .target = input.target,
                                  .tolerance = float(input.tolerance),
                                  .groups_in_dispatch = in_dispatch});
    pass.read("coarse", coarse);
    pixel_groups(pass, blocks, {});
    Adapted adapted;
    adapted.target = pass.write("color", target);
    adapted.blocks = {pass.write("blocks", numbers), pass.modify("dispatches", counts), groups, in_dispatch};
    return adapted;
}

void listed_groups(Pass& pass, const std::optional<ListedBlocks>& blocks)
{
    if (!blocks) {
        constexpr uint32_t NONE[] = {gpu::NO_BLOCK};
        pass.block("listed_blocks", std::span<const uint32_t>(NONE));
        pass.push(uint32_t{0});
        return;
    }
    pass.read("listed_blocks", blocks->numbers);
    const auto threads = [](uint32_t groups) { return glm::uvec3(GROUP_SIDE * groups, GROUP_SIDE, 1); };
    pass.dispatch_counted(blocks->counts, threads(blocks->most_groups), threads(blocks->groups_in_dispatch));
}

}  // namespace shvr

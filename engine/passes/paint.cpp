#include "engine/passes/paint.h"

namespace shvr {

namespace {

struct Labelled {
    Resource bits, parents;
};

glm::uvec3 words_of(const gpu::RegionParams& params)
{
    return {params.words_per_row, params.size.y, params.size.z};
}

uint64_t word_bytes(const gpu::RegionParams& params)
{
    const glm::uvec3 words = words_of(params);
    return uint64_t(words.x) * words.y * words.z * sizeof(uint32_t);
}

Labelled region_bits(FrameGraph& graph, const VolumeBinding& volume, const RegionInput& input)
{
    Pass pass = graph.compute("region_bits", {{"FILTERED", volume.filtered}});
    pass.read("atlas", volume.atlas);
    pass.block("region_bricks", std::span<const uint32_t>(input.bricks.slots));
    pass.block("rows", input.rows);
    gpu::RegionParams params = input.params;
    params.brick_begin = input.bricks.begin;
    params.brick_counts = input.bricks.counts;
    pass.push(params);
    pass.dispatch(words_of(input.params));
    return {pass.write("bits", graph.create("region bits", buffer_desc(word_bytes(input.params)))),
            pass.write("parents", graph.create("region parents", buffer_desc(word_bytes(input.params) * 32)))};
}

Labelled region_merge(FrameGraph& graph, const RegionInput& input, const Labelled& region)
{
    Pass pass = graph.compute("region_merge");
    pass.read("bits", region.bits);
    pass.push(input.params);
    pass.dispatch(words_of(input.params));
    return {region.bits, pass.modify("parents", region.parents)};
}

Resource region_mark(FrameGraph& graph, const RegionInput& input, const Labelled& region, Resource marked)
{
    Pass pass = graph.compute("region_mark");
    pass.read("bits", region.bits);
    pass.read("parents", region.parents);
    pass.block("rows", input.rows);
    pass.push(input.params);
    pass.dispatch(words_of(input.params));
    return pass.modify("marked", marked);
}

Resource region_select(FrameGraph& graph, const RegionInput& input, const Labelled& region, Resource marked, bool flood)
{
    Pass pass = graph.compute("region_select");
    pass.read("bits", region.bits);
    pass.read("parents", region.parents);
    pass.read("marked", marked);
    pass.constant("FLOOD", flood);
    pass.push(input.params);
    pass.dispatch(words_of(input.params));
    return pass.write("selected", graph.create("region selected", buffer_desc(word_bytes(input.params))));
}

}  // namespace

Resource select_fill(FrameGraph& graph, const VolumeBinding& volume, const RegionInput& input)
{
    return region_bits(graph, volume, input).bits;
}

Resource select_flood(FrameGraph& graph, const VolumeBinding& volume, const RegionInput& input)
{
    const Labelled region = region_merge(graph, input, region_bits(graph, volume, input));
    return region_select(graph, input, region, region.bits, true);  // a flood fill reads no marks
}

Resource select_speckles(FrameGraph& graph, const VolumeBinding& volume, const RegionInput& input)
{
    const Labelled region = region_merge(graph, input, region_bits(graph, volume, input));
    const Resource clear =
        graph.fill(graph.create("region marked", buffer_desc(word_bytes(input.params))), 0, "clear marks");
    return region_select(graph, input, region, region_mark(graph, input, region, clear), false);
}

}  // namespace shvr

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

std::vector<std::pair<std::string, uint32_t>> constants_of_bits(const VolumeBinding& volume)
{
    std::vector<std::pair<std::string, uint32_t>> constants = constants_of_codes(volume, true);
    constants.emplace_back("IN_SLOTS", volume.in_slots);
    return constants;
}

Labelled region_bits(FrameGraph& graph, const VolumeBinding& volume, const RegionInput& input)
{
    Pass pass = graph.compute("region_bits", {{"FILTERED", volume.is_filtered()}});
    for (const auto& [name, value] : constants_of_bits(volume)) pass.constant(name, value);
    bind_stacked_atlas(pass, volume);
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

Labelled region_merge(FrameGraph& graph, const gpu::RegionParams& params, const Labelled& region)
{
    Pass pass = graph.compute("region_merge");
    pass.read("bits", region.bits);
    pass.push(params);
    pass.dispatch(words_of(params));
    return {region.bits, pass.modify("parents", region.parents)};
}

Resource region_mark(FrameGraph& graph, const gpu::RegionParams& params, std::span<const gpu::RowSpan> rows,
                     const Labelled& region, Resource marked)
{
    Pass pass = graph.compute("region_mark");
    pass.read("bits", region.bits);
    pass.read("parents", region.parents);
    pass.block("rows", rows);
    pass.push(params);
    pass.dispatch(words_of(params));
    return pass.modify("marked", marked);
}

Resource no_marks(FrameGraph& graph, const gpu::RegionParams& params)
{
    return graph.fill(graph.create("region marked", buffer_desc(word_bytes(params))), 0, "clear marks");
}

Labelled region_roots(FrameGraph& graph, const gpu::RegionParams& params, Resource mask)
{
    Pass pass = graph.compute("region_roots");
    pass.read("mask", mask);
    pass.push(params);
    pass.dispatch(words_of(params));
    return {pass.write("bits", graph.create("region bits", buffer_desc(word_bytes(params)))),
            pass.write("parents", graph.create("region parents", buffer_desc(word_bytes(params) * 32)))};
}

Resource region_seeds(FrameGraph& graph, const gpu::RegionParams& params, const Labelled& region, const SeedBits& seeds)
{
    const Resource marked = no_marks(graph, params);
    Pass pass = graph.compute("region_seeds");
    pass.read("bits", region.bits);
    pass.read("parents", region.parents);
    pass.read("seeds", seeds.words);
    pass.push(gpu::SeedParams{.size = params.size,
                              .words_per_row = params.words_per_row,
                              .to_seeds = seeds.from_region,
                              .seed_size = seeds.size,
                              .seed_words_per_row = seeds.words_per_row});
    pass.dispatch(words_of(params));
    return pass.modify("marked", marked);
}

Resource region_select(FrameGraph& graph, const gpu::RegionParams& params, const Labelled& region, Resource marked,
                       uint32_t keep)
{
    Pass pass = graph.compute("region_select");
    pass.read("bits", region.bits);
    pass.read("parents", region.parents);
    pass.read("marked", marked);
    pass.constant("KEEP", keep);
    pass.push(params);
    pass.dispatch(words_of(params));
    return pass.write("selected", graph.create("region selected", buffer_desc(word_bytes(params))));
}

}  // namespace

void expect_brushes(FrameGraph& graph, const VolumeBinding& volume)
{
    graph.expect({variant_of("region_bits", {{"FILTERED", volume.is_filtered()}}), constants_of_bits(volume)});
    for (const char* kernel : {"region_merge", "region_mark"}) graph.expect({kernel, {}});
    for (const uint32_t keep : {gpu::KEEP_SEED, gpu::KEEP_UNMARKED}) graph.expect({"region_select", {{"KEEP", keep}}});
}

Resource select_fill(FrameGraph& graph, const VolumeBinding& volume, const RegionInput& input)
{
    return region_bits(graph, volume, input).bits;
}

namespace {

Resource flood(FrameGraph& graph, const gpu::RegionParams& params, const Labelled& bits)
{
    const Labelled region = region_merge(graph, params, bits);
    return region_select(graph, params, region, region.bits, gpu::KEEP_SEED);  // a flood fill does not read marks
}

Resource speckles(FrameGraph& graph, const gpu::RegionParams& params, std::span<const gpu::RowSpan> rows,
                  const Labelled& bits)
{
    const Labelled region = region_merge(graph, params, bits);
    return region_select(graph, params, region, region_mark(graph, params, rows, region, no_marks(graph, params)),
                         gpu::KEEP_UNMARKED);
}

Labelled known_bits(FrameGraph& graph, const gpu::RegionParams& params, std::span<const uint32_t> bits)
{
    return region_roots(graph, params, graph.upload("region mask", bits));
}

}  // namespace

Resource select_flood(FrameGraph& graph, const VolumeBinding& volume, const RegionInput& input)
{
    return flood(graph, input.params, region_bits(graph, volume, input));
}

Resource select_speckles(FrameGraph& graph, const VolumeBinding& volume, const RegionInput& input)
{
    return speckles(graph, input.params, input.rows, region_bits(graph, volume, input));
}

Resource select_flood_in(FrameGraph& graph, const gpu::RegionParams& params, std::span<const uint32_t> bits)
{
    return flood(graph, params, known_bits(graph, params, bits));
}

Resource select_speckles_in(FrameGraph& graph, const gpu::RegionParams& params, std::span<const gpu::RowSpan> rows,
                            std::span<const uint32_t> bits)
{
    return speckles(graph, params, rows, known_bits(graph, params, bits));
}

Resource select_object(FrameGraph& graph, const gpu::RegionParams& params, Resource mask, const SeedBits& seeds)
{
    const Labelled region = region_merge(graph, params, region_roots(graph, params, mask));
    return region_select(graph, params, region, region_seeds(graph, params, region, seeds), gpu::KEEP_MARKED);
}

}  // namespace shvr

#include "engine/passes/surfaces.h"

#include <algorithm>
#include <span>

#include "engine/passes/raycast.h"

namespace shvr {

namespace {

/// Lists the surfaces of each tile. `tiles` already contains the words written by earlier blocks of nodes.
Resource tiles_block(FrameGraph& graph, const SurfacesInput& input, Resource tiles)
{
    const glm::uvec2 pixels = input.params.pixel_end - input.params.pixel_begin;
    Pass pass = graph.compute("surface_tiles");
    pass.block("params_block", std::span(&input.params, 1));
    pass.block("surface_params", std::span(&input.scene, 1));
    pass.read("surface_nodes", input.listed->nodes);
    pass.read("surface_list", input.listed->list);
    pass.constant("TRIANGLES", input.listed->triangles);
    pixel_groups(pass, gpu::surface_tiles_of(pixels), {.layers = input.pixel_groups.layers});
    return input.scene.first_node > 0 ? pass.modify("surface_tiles", tiles) : pass.write("surface_tiles", tiles);
}

/// One round of the search of all rays.
Resource surfaces_round(FrameGraph& graph, const SurfacesInput& input, Resource target, Resource tiles)
{
    const glm::uvec2 pixels = input.params.pixel_end - input.params.pixel_begin;
    Pass pass = graph.compute("surfaces", {{"LISTED", input.listed.has_value()}});
    pass.block("params_block", std::span(&input.params, 1));
    pass.block("surface_params", std::span(&input.scene, 1));
    if (input.listed) {
        pass.read("surface_nodes", input.listed->nodes);
        pass.read("surface_list", input.listed->list);
        pass.read("surface_tiles", tiles);
    }
    pass.constant("GROUP_WIDTH", input.pixel_groups.width);
    pass.constant("SHININESS_SQUARINGS", shininess_squarings(input.params.shininess));
    pass.constant("DISTANCE_BLEND", input.params.blend_size > 0.0f);
    pass.constant("PROBE", input.probe);
    pass.constant("TRIANGLES", input.listed && input.listed->triangles);
    pixel_groups(pass, pixels, input.pixel_groups);
    return input.scene.is_first_round ? pass.write("surfaces", target) : pass.modify("surfaces", target);
}

}  // namespace

Resource surfaces(FrameGraph& graph, const SurfacesInput& input)
{
    const glm::uvec2 pixels = input.params.pixel_end - input.params.pixel_begin;
    const uint32_t nodes = input.listed ? input.scene.node_count : 0;
    const uint32_t blocks = std::max((nodes + input.nodes_in_dispatch - 1) / input.nodes_in_dispatch, 1u);
    SurfacesInput part = input;
    part.scene.end_node = nodes;
    part.scene.nodes_in_round = input.nodes_in_dispatch;
    Resource tiles;
    if (input.listed) {
        const glm::uvec2 counts = gpu::surface_tiles_of(pixels);
        tiles = graph.create("surface tiles", picture_desc(Format::r32_uint, gpu::SURFACE_TILE * counts));
        for (uint32_t block = 0; block < blocks; ++block) {
            part.scene.first_node = block * input.nodes_in_dispatch;
            part.scene.end_node = std::min(part.scene.first_node + input.nodes_in_dispatch, nodes);
            tiles = tiles_block(graph, part, tiles);
        }
    }
    Resource target = graph.create("surfaces", picture_desc(Format::rgba32_float, pixels));
    const uint32_t rounds = input.listed && input.listed->triangles ? std::min(blocks, input.max_rounds) : blocks;
    for (uint32_t round = 0; round < rounds; ++round) {
        part.scene.is_first_round = round == 0;
        part.scene.is_last_round = round + 1 == rounds;
        target = surfaces_round(graph, part, target, tiles);
    }
    return target;
}

Resource nearer(FrameGraph& graph, Resource other, Resource surfaces, const glm::uvec2& size)
{
    Pass pass = graph.compute("nearer");
    pass.read("other", other);
    pass.push(gpu::NearerParams{.size = size});
    pass.dispatch({size.x, size.y, 1});
    return pass.modify("surfaces", surfaces);
}

}  // namespace shvr

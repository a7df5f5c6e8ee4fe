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

Resource surfaces_block(FrameGraph& graph, const SurfacesInput& input, Resource target, Resource tiles)
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
    return input.scene.first_node > 0 ? pass.modify("surfaces", target) : pass.write("surfaces", target);
}

}  // namespace

Resource surfaces(FrameGraph& graph, const SurfacesInput& input)
{
    const glm::uvec2 pixels = input.params.pixel_end - input.params.pixel_begin;
    const uint32_t nodes = input.listed ? input.scene.node_count : 0;
    std::vector<SurfacesInput> blocks;
    for (uint32_t first = 0; first == 0 || first < nodes; first += input.nodes_in_dispatch) {
        SurfacesInput& block = blocks.emplace_back(input);
        block.scene.first_node = first;
        block.scene.end_node = std::min(first + input.nodes_in_dispatch, nodes);
        block.scene.is_last_block = first + input.nodes_in_dispatch >= nodes;
    }
    Resource tiles;
    if (input.listed) {
        const glm::uvec2 counts = gpu::surface_tiles_of(pixels);
        tiles = graph.create("surface tiles", picture_desc(Format::r32_uint, gpu::SURFACE_TILE * counts));
        for (const SurfacesInput& block : blocks) tiles = tiles_block(graph, block, tiles);
    }
    Resource target = graph.create("surfaces", picture_desc(Format::rgba32_float, pixels));
    for (const SurfacesInput& block : blocks) target = surfaces_block(graph, block, target, tiles);
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

#include "engine/passes/surfaces.h"

#include <algorithm>
#include <span>

#include "engine/passes/pixel_groups.h"
#include "engine/passes/raycast.h"

namespace shvr {

namespace {

/// Nodes that one dispatch may look at: with their surfaces, half of the 65535 turns after which some devices end a
/// thread's loops. A node is visited once at most, so lanes in step do not take each other's turns.
constexpr uint32_t NODES_OF_BLOCK = 32768 / 6;

Resource surfaces_block(FrameGraph& graph, const SurfacesInput& input, Resource target)
{
    const glm::uvec2 pixels = input.params.pixel_end - input.params.pixel_begin;
    Pass pass = graph.compute("surfaces", {{"LISTED", input.listed.has_value()}});
    pass.block("params_block", std::span(&input.params, 1));
    pass.block("surface_params", std::span(&input.scene, 1));
    if (input.listed) {
        pass.read("surface_nodes", input.listed->nodes);
        pass.read("surface_list", input.listed->list);
    }
    pass.constant("GROUP_WIDTH", input.group_width);
    pass.constant("SHININESS_SQUARINGS", shininess_squarings(input.params.shininess));
    pass.constant("DISTANCE_BLEND", input.params.blend_size > 0.0f);
    pass.constant("PROBE", input.probe);
    pixel_groups(pass, pixels, input.group_width, input.tile);
    return input.scene.first_node > 0 ? pass.modify("surfaces", target) : pass.write("surfaces", target);
}

}  // namespace

Resource surfaces(FrameGraph& graph, const SurfacesInput& input)
{
    const glm::uvec2 pixels = input.params.pixel_end - input.params.pixel_begin;
    const uint32_t nodes = input.listed ? input.scene.node_count : 0;
    Resource target = graph.create("surfaces", picture_desc(Format::rgba32_float, pixels));
    SurfacesInput block = input;
    for (uint32_t first = 0; first == 0 || first < nodes; first += NODES_OF_BLOCK) {
        block.scene.first_node = first;
        block.scene.end_node = std::min(first + NODES_OF_BLOCK, nodes);
        block.scene.is_last_block = first + NODES_OF_BLOCK >= nodes;
        target = surfaces_block(graph, block, target);
    }
    return target;
}

}  // namespace shvr

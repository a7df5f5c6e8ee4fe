#include "engine/passes/surfaces.h"

#include <span>

#include "engine/passes/pixel_groups.h"
#include "engine/passes/raycast.h"

namespace shvr {

Resource surfaces(FrameGraph& graph, const SurfacesInput& input)
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
    return pass.write("surfaces", graph.create("surfaces", image_desc(Format::rgba32_float, glm::uvec3(pixels, 1))));
}

}  // namespace shvr

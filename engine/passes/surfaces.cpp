#include "engine/passes/surfaces.h"

#include <span>

#include "engine/passes/raycast.h"

namespace shvr {

Resource surfaces(FrameGraph& graph, const SurfacesInput& input)
{
    const glm::uvec2 pixels = input.params.pixel_end - input.params.pixel_begin;
    Pass pass = graph.compute(input.listed ? "surfaces_listed" : "surfaces", "surfaces");
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
    const glm::uvec2 group(input.group_width, 64 / input.group_width);
    pass.dispatch(glm::uvec3((pixels + group - 1u) / group * 8u, 1),
                  glm::uvec3(input.tile / group * 8u, input.tile.x > 0));
    return pass.write("surfaces", graph.create("surfaces", image_desc(Format::rgba32_float, glm::uvec3(pixels, 1))));
}

}  // namespace shvr

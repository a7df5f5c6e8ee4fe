#include "engine/passes/raycast.h"

namespace shvr {

Resource raycast(FrameGraph& graph, const VolumeBinding& volume, const RaycastInput& input)
{
    const glm::uvec3 pixels(input.params.pixels, 1);
    Pass pass = graph.compute(
        std::string("raycast") + (volume.filtered ? "_filtered" : "") + (input.mask ? "_masked" : ""), "raycast");
    pass.block("params_block", std::span(&input.params, 1));
    pass.read("table", input.table);
    pass.read("leap", volume.leap);
    pass.read("atlas", volume.atlas);
    if (input.mask) {
        pass.read("mask", input.mask->mask);
        pass.read("mask_table", input.mask->mask_table);
        pass.block("groups", std::span<const gpu::GroupLook>(input.groups));
    }
    pass.constant("SHADED", input.shaded);
    pass.constant("COUNT_WORK", input.count_work);
    pass.constant("GROUP_WIDTH", input.group_width);
    // The kernel is 8 x 8 threads a group, whatever the shape of the pixels it covers.
    const glm::uvec2 group(input.group_width, 64 / input.group_width);
    pass.dispatch(glm::uvec3((input.params.pixels + group - 1u) / group * 8u, 1),
                  glm::uvec3(input.tile / group * 8u, input.tile.x > 0));
    return pass.write("color", graph.create("color", image_desc(Format::rgba32_float, pixels)));
}

}  // namespace shvr

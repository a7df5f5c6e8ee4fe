#include "engine/passes/raycast.h"

#include <cmath>

#include "engine/passes/pixel_groups.h"

namespace shvr {

uint32_t shininess_squarings(float shininess)
{
    for (uint32_t k = 0; k < gpu::NOT_A_POWER_OF_TWO; ++k)
        if (shininess == std::ldexp(1.0f, int(k))) return k;
    return gpu::NOT_A_POWER_OF_TWO;
}

Resource raycast(FrameGraph& graph, VolumeBinding& volume, const RaycastInput& input, Resource target)
{
    const glm::uvec2 pixels = input.params.pixel_end - input.params.pixel_begin;
    const bool is_shelled = input.shell != gpu::SHELL_NONE && !input.pick;
    Pass pass = graph.compute("raycast", {{"PAGED", volume.pages.has_value()},
                                          {"FILTERED", volume.filtered},
                                          {"MASKED", input.mask.has_value()},
                                          {"OCCLUDED", input.occlusion.has_value()},
                                          {"SURFACED", input.surfaces.has_value()},
                                          {"SHELLED", is_shelled}});
    pass.block("params_block", std::span(&input.params, 1));
    pass.read("table", input.table);
    if (volume.pages) {
        pass.read("directory", volume.pages->directory);
        pass.read("cell_leap", volume.pages->cell_leap);
        pass.constant("FEEDBACK", volume.pages->feedback);
        volume.pages->reached = pass.modify("reached", volume.pages->reached);
    } else {
        pass.read("leap", volume.leap);
    }
    pass.read("atlas", volume.atlas);
    if (input.mask) {
        pass.read("mask", input.mask->mask);
        pass.read("mask_table", input.mask->mask_table);
        pass.read("groups", input.groups);
    }
    if (input.occlusion) {
        pass.read("occlusion", input.occlusion->values);
        pass.block("occlusion_look", std::span<const gpu::OcclusionLook>(&input.occlusion->look, 1));
    }
    if (input.surfaces) pass.read("surfaces", *input.surfaces);
    pass.constant("SHADED", input.shaded);
    if (input.shaded) pass.constant("SHININESS_SQUARINGS", shininess_squarings(input.params.shininess));
    pass.constant("COUNT_WORK", input.count_work);
    pass.constant("GROUP_WIDTH", input.group_width);
    pass.constant("SLICE", input.slice);
    pass.constant("PREINTEGRATED", input.preintegrated);
    if (is_shelled) pass.constant("SHELL", input.shell);
    pass.constant("PICK", input.pick);
    pass.constant("DISTANCE_BLEND", input.params.blend_size > 0.0f);
    pixel_groups(pass, pixels, input.group_width, input.tile);
    return pass.write("color", target);
}

}  // namespace shvr

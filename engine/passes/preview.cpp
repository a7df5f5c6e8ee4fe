#include "engine/passes/preview.h"

#include "engine/passes/pixel_groups.h"
#include "engine/passes/raycast.h"

namespace shvr {

PreviewSeen preview(FrameGraph& graph, const PreviewInput& input)
{
    const glm::uvec2 pixels = input.params.pixel_end - input.params.pixel_begin;
    const ResourceDesc desc = picture_desc(Format::rgba32_float, pixels);
    Pass pass = graph.compute("preview", {{"SURFACED", input.surfaces.has_value()}});
    pass.block("params_block", std::span(&input.params, 1));
    pass.block("preview_params", std::span(&input.preview, 1));
    pass.block("preview_words", input.words);
    if (input.surfaces) pass.read("surfaces", *input.surfaces);
    pass.constant("GROUP_WIDTH", input.group_width);
    pass.constant("SHININESS_SQUARINGS", shininess_squarings(input.params.shininess));
    pass.constant("DISTANCE_BLEND", input.params.blend_size > 0.0f);
    pass.constant("SLICE", input.slice);
    pixel_groups(pass, pixels, input.group_width);
    PreviewSeen made;
    const Resource nearest = pass.write("nearest", graph.create("preview surfaces", desc));
    if (!input.slice) made.surfaces = nearest;
    made.seen = pass.write("seen", graph.create("preview", desc));
    return made;
}

Resource preview_over(FrameGraph& graph, Resource seen, Resource target, const gpu::PreviewOverParams& params)
{
    Pass pass = graph.compute("preview_over");
    pass.read("seen", seen);
    pass.push(params);
    pass.dispatch({params.size.x, params.size.y, 1});
    return pass.modify("color", target);
}

}  // namespace shvr

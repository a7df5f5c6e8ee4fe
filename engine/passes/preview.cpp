#include "engine/passes/preview.h"

#include "engine/passes/raycast.h"

namespace shvr {

namespace {

KernelVariant kernel_of(const PreviewInput& input)
{
    return {variant_of("preview", {{"SURFACED", input.surfaces.has_value()}}),
            {{"GROUP_WIDTH", input.pixel_groups.width},
             {"SHININESS_SQUARINGS", shininess_squarings(input.params.shininess)},
             {"DISTANCE_BLEND", input.params.blend_size > 0.0f},
             {"SLICE", input.slice}}};
}

}  // namespace

void expect_preview(FrameGraph& graph, const PreviewInput& input)
{
    graph.expect(kernel_of(input));
    graph.expect({"preview_over", {}});
}

PreviewSeen preview(FrameGraph& graph, const PreviewInput& input)
{
    const glm::uvec2 pixels = input.params.pixel_end - input.params.pixel_begin;
    const ResourceDesc desc = picture_desc(Format::rgba32_float, pixels);
    const KernelVariant kernel = kernel_of(input);
    Pass pass = graph.compute(kernel.first, "preview");
    for (const auto& [name, value] : kernel.second) pass.constant(name, value);
    pass.block("params_block", std::span(&input.params, 1));
    pass.block("preview_params", std::span(&input.preview, 1));
    pass.block("preview_words", input.words);
    if (input.surfaces) pass.read("surfaces", *input.surfaces);
    pixel_groups(pass, pixels, {.width = input.pixel_groups.width, .layers = input.pixel_groups.layers});
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

// The pixel that a thread draws if drawing is limited to listed blocks of pixels (adaptive.h). The includer declares
// binding LISTED_BLOCKS_BINDING.

layout(push_constant) uniform Push { uint groups_before; };   // in the dispatches before this one
layout(binding = LISTED_BLOCKS_BINDING, scalar) readonly buffer Blocks { uint numbers[]; } listed_blocks;

// The pixel relative to pixel_begin; beyond pixel_end if there is none.
uvec2 listed_in_part(uvec2 pixel_begin, uvec2 pixel_end)
{
    const uint eight = gl_LocalInvocationIndex / 8u, in_eight = gl_LocalInvocationIndex % 8u;
    const uint listed = listed_blocks.numbers[ADAPTIVE_BLOCKS_IN_GROUP * (groups_before + gl_WorkGroupID.x) + eight];
    const uint columns = adaptive_blocks(pixel_begin, pixel_end).x;
    const uvec2 block = uvec2(listed % columns, listed / columns);
    const uvec2 pixel = adaptive_begin(pixel_begin) + block * uvec2(ADAPTIVE_BLOCK_X, ADAPTIVE_BLOCK_Y) +
                        uvec2(in_eight % ADAPTIVE_BLOCK_X, in_eight / ADAPTIVE_BLOCK_X);
    const bool is_one = listed != NO_BLOCK && all(greaterThanEqual(pixel, pixel_begin));
    return is_one ? pixel - pixel_begin : uvec2(0xffffffffu);
}

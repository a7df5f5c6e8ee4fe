// State of a ray that a dispatch stores for the next dispatch (raycast.h, KEPT). Needs the constant KEPT.
#if defined(PAGED) || defined(SHELLED)
#define KEEPS
layout(binding = 13, rgba32f) uniform image2D rays;   // KEPT_NOTHING: one texel
#endif

struct Kept {
    vec4 sum;         // KEPT_ALL: what the ray has gathered
    vec2 shell;       // length to the next iso-surface, and length from which the search continues
    uint step;        // KEPT_ALL: index of the next step
    bool is_inside;   // KEPT_ALL: whether the ray is inside the iso-surface
    bool is_done;     // KEPT_ALL
};

#ifdef KEEPS
// Returns the texel of the second half of a ray's state, below the first half by the drawn part's height.
ivec2 second_half(const RaycastParams params, uvec2 in_part)
{
    return ivec2(in_part.x, in_part.y + (params.pixel_end.y - params.pixel_begin.y));
}

Kept kept_of(const RaycastParams params, uvec2 in_part)
{
    const vec4 first = imageLoad(rays, ivec2(in_part));
    const uint step_and_state = uint(first.w), state = step_and_state >> 16u;
    Kept kept = Kept(vec4(0.0), first.xy, uint(first.z) + ((step_and_state & 0xffffu) << 16u),
                     (state & RAY_IS_INSIDE) != 0u, (state & RAY_IS_DONE) != 0u);
    if (KEPT == KEPT_ALL) kept.sum = imageLoad(rays, second_half(params, in_part));
    return kept;
}

void keep(const RaycastParams params, uvec2 in_part, const Kept kept)
{
    const uint state = (kept.is_inside ? RAY_IS_INSIDE : 0u) | (kept.is_done ? RAY_IS_DONE : 0u);
    imageStore(rays, ivec2(in_part),
               vec4(kept.shell, float(kept.step & 0xffffu), float(kept.step >> 16u | state << 16u)));
    if (KEPT == KEPT_ALL) imageStore(rays, second_half(params, in_part), kept.sum);
}
#endif

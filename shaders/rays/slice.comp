// A slice through the volume: one sample half-way along each pixel's ray, in grey, regardless of the transfer function.
// Macros: see volume.glsl.
// variants: PAGED FILTERED MASKED
//
// PAGED: a ray may wait for the brick of its sample (raycast.h, KEPT_ALL).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "../raycast.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(constant_id = 2) const uint GROUP_WIDTH = 8u;
layout(constant_id = 5) const uint FEEDBACK = 0u;   // as in raycast.comp
layout(constant_id = 6) const uint DISTANCE_BLEND = 0u;
layout(constant_id = 10) const uint KEPT = KEPT_NOTHING;
const uint COUNT_WORK = 0u;

layout(binding = 4, rgba32f) uniform writeonly image2D color;

#include "volume.glsl"
#include "ray.glsl"
#include "../library/blend.glsl"
#include "../library/texels.glsl"
#ifdef MASKED
#include "../library/groups.glsl"
#endif
#include "kept.glsl"

// Perceptually uniform grey: the inverse of the curve by which pictures are encoded (IEC 61966-2-1).
vec4 slice_look(const RaycastParams params, float density)
{
    const float grey = clamp((density - params.slice_black) * params.slice_scale, 0.0, 1.0);
    const float light = grey <= 0.04045 ? grey / 12.92 : exp2(2.4 * log2((grey + 0.055) / 1.055));
    return vec4(vec3(light), 1.0);
}

#ifdef MASKED
vec4 painted(const RaycastParams params, uint group, vec4 look)
{
    if (group == 0u) return look;
    const vec4 of_group = imageLoad(groups, ivec2(group, 0));
    return vec4(mix(look.rgb, of_group.rgb, of_group.a > 0.0 ? params.slice_paint : 0.0), 1.0);
}
#endif

// Shows the sample even if the transfer function hides it. The caller excludes samples outside the view.
vec4 sliced(const RaycastParams params, vec3 position, out bool waits)
{
    const Place place = brick_at(params, position);
    waits = place.is_missing;
#ifdef PAGED
    if (FEEDBACK != 0u && (KEPT != KEPT_ALL || place.is_missing)) note_reached(place);
    if (place.distance > 0u || waits) return vec4(0.0);
#endif
    const Texels texels = texels_at(position, place);
    vec4 look = slice_look(params, value_of(density_at(texels.corner + texels.to_atlas, texels.fraction)));
#ifdef MASKED
    if (place.is_painted) look = painted(params, group_of(to_uint(position)), look);
#endif
    if (DISTANCE_BLEND != 0u) look.rgb = blended(params, look.rgb, position);
    return look;
}

void main()
{
    const RaycastParams params = params_block.data;
    const uvec2 in_part = params.drawn_begin + thread_in_part();
    if (any(greaterThanEqual(in_part, params.drawn_end))) return;
    Span span;
    const Ray ray = ray_of(params, params.pixel_begin + in_part, span);
    vec4 seen = vec4(0.0);
    bool is_done = false, waits = false;
#ifdef PAGED
    if (KEPT == KEPT_ALL && params.first_step > 0u) {
        const Kept kept = kept_of(params, in_part);
        seen = kept.sum;
        is_done = kept.is_done;
    }
#endif
    const float plane = 0.5 * span.to_far;
    if (!is_done && span.begin <= plane && plane <= span.end)
        seen = sliced(params, position_at(params, ray, plane), waits);
#ifdef PAGED
    if (KEPT == KEPT_ALL) keep(params, in_part, Kept(seen, vec2(0.0), 0u, false, !waits));
#endif
    imageStore(color, ivec2(params.target + in_part), over_background(params, seen));
}

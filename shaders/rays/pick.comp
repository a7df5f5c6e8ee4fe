// Finds the point at which the user points: stores the place (in voxel space) where the opacity rises most along a
// pixel's ray, and the ray's opacity, or 0 if the rise is too small to be seen. Rays are those of raycast.comp, without
// their colours. The target has PICK_ROWS rows (raycast.h). Macros: see volume.glsl.
// variants: PAGED FILTERED MASKED
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "../raycast.h"
#include "../surfaces.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(constant_id = 2) const uint GROUP_WIDTH = 8u;
layout(constant_id = 4) const uint HAS_SURFACES = 0u;      // rays end at opaque surfaces (surfaces.comp)
layout(constant_id = 9) const uint PREINTEGRATED = 0u;     // as in raycast.comp
layout(constant_id = 11) const uint SMOOTH_BORDERS = 0u;   // as in raycast.comp
// Switches off the parts of the ray caster that picking does not need.
const uint SHADED = 0u, COUNT_WORK = 0u, FEEDBACK = 0u, KEPT = KEPT_NOTHING;

layout(binding = 4, rgba32f) uniform image2D color;
layout(binding = 12, rgba32f) uniform readonly image2D surfaces;   // linear RGB, length along the ray

#include "../library/counters.glsl"
#include "volume.glsl"
#include "ray.glsl"
#define PICKS
#include "march.glsl"

// Continues where an earlier dispatch stopped.
void resume(ivec2 texel, inout March march)
{
    march.sum = imageLoad(color, texel);
    const vec4 runs = imageLoad(color, texel + ivec2(0, 1)), run = imageLoad(color, texel + ivec2(0, 2));
    march.rises = Rises(runs.x, runs.y, runs.z, runs.w, run.x, run.y, run.z);
}

void keep(ivec2 texel, const March march)
{
    const Rises rises = march.rises;
    imageStore(color, texel, march.sum);
    imageStore(color, texel + ivec2(0, 1), vec4(rises.most, rises.most_at, rises.run, rises.steepest));
    imageStore(color, texel + ivec2(0, 2), vec4(rises.steepest_at, rises.peak, rises.trough, 0.0));
}

void main()
{
    const RaycastParams params = params_block.data;
    const uvec2 in_part = params.drawn_begin + thread_in_part();
    if (any(greaterThanEqual(in_part, params.drawn_end))) return;
    Span span;
    const Ray ray = ray_of(params, params.pixel_begin + in_part, span);
    vec4 surface = vec4(0.0, 0.0, 0.0, NO_SURFACE);
    if (HAS_SURFACES != 0u) surface = imageLoad(surfaces, ivec2(in_part));
    if (HAS_SURFACES != 0u) span.end = min(span.end, max(surface.a, span.begin));
    const Lattice lattice = lattice_of(params, span.begin, span.end);
    const Block block = block_of(params, lattice);
    const ivec2 texel = ivec2(params.target + in_part);
    March march = march_from(block.first, vec4(0.0));
    if (params.first_step > 0u) resume(texel, march);
    if (params.first_step > 0u && march.sum.a >= params.opacity_limit) return;   // what was found stays

    Work work = no_work();
    take_samples(params, ray, lattice, block.end, NO_SHELL, march, work);
    add_rest(params, lattice, march);
    count(COUNTER_CUT_SHORT, uint(is_cut_short(params, lattice, block, march)));
    const bool is_stopped = march.sum.a >= params.opacity_limit;
    if (!block.is_last && !is_stopped) {
        keep(texel, march);
        return;
    }
    vec3 seen = position_at(params, ray, march.rises.most_at);
    if (!is_stopped && surface.a < NO_SURFACE) {
        if (1.0 - march.sum.a > march.rises.most) {
            march.rises.most = 1.0 - march.sum.a;
            seen = ray.origin + surface.a * ray.direction;  // may be outside the volume
        }
        accumulate(march.sum, vec4(surface.rgb, 1.0));
    }
    imageStore(color, texel, march.rises.most >= MIN_SEEN ? vec4(seen, march.sum.a) : vec4(0.0));
}

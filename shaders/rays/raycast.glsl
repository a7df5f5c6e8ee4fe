// Draws pictures by rays. Included by raycast.comp, which samples steps, and by integral.comp, which defines INTEGRATED
// and integrates light between borders. These files list the macros. One pixel per thread.
#include "../raycast.h"
#ifdef OCCLUDED
#include "../occlusion/occlusion.h"
#endif
#ifdef SURFACED
#include "../surfaces.h"
#endif

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(constant_id = 0) const uint SHADED = 1u;
layout(constant_id = 1) const uint COUNT_WORK = 0u;
// Rows of bricks are contiguous along x, so a wider group of pixels uses more of each cache line on devices with linear
// images.
layout(constant_id = 2) const uint GROUP_WIDTH = 8u;
layout(constant_id = 3) const uint SHININESS_SQUARINGS = NOT_A_POWER_OF_TWO;
// 1: records the bricks that rays visit; complete pictures do not need this.
layout(constant_id = 5) const uint FEEDBACK = 0u;
layout(constant_id = 6) const uint DISTANCE_BLEND = 0u;
#ifdef INTEGRATED
const uint PREINTEGRATED = 0u, ANALYTIC_GRADIENT = 0u;
#else
// 1: shades by the derivative of the interpolation instead of central differences.
layout(constant_id = 7) const uint ANALYTIC_GRADIENT = 0u;
// 1: classifies a step by the densities at its two ends. 2: the same, and rays also end at opaque densities.
layout(constant_id = 9) const uint PREINTEGRATED = 0u;
#endif
layout(constant_id = 10) const uint KEPT = KEPT_NOTHING;
// 1: assigns a sample to the group with the largest weight among the eight voxels around it. 0: to the group of the
// nearest voxel.
layout(constant_id = 11) const uint SMOOTH_BORDERS = 0u;
#ifdef SHELLED
layout(constant_id = 8) const uint SHELL = SHELL_BALL;   // the region's shape
layout(binding = 19, r32ui) uniform readonly uimage3D cell_ranges;   // minimum | maximum << 16
#endif

layout(binding = 4, rgba32f) uniform image2D color;
#ifdef OCCLUDED
// 1: ambient light follows a curve of points instead of a power law (occlusion.h).
layout(constant_id = 14) const uint OCCLUSION_MAPPED = 0u;
layout(binding = 10, r8ui) uniform readonly uimage3D occlusion;
layout(binding = 11, scalar) readonly buffer Look { OcclusionLook data; OcclusionSegment segments[]; } occlusion_look;
#include "../occlusion/occlusion.glsl"
#endif
#ifdef SURFACED
layout(binding = 12, rgba32f) uniform readonly image2D surfaces;   // linear RGB, length along the ray
#endif

#include "../library/counters.glsl"
#include "volume.glsl"
#include "ray.glsl"
#include "../library/shade.glsl"
#include "march.glsl"
#ifdef SHELLED
#include "../library/shell.glsl"
#endif
#include "kept.glsl"

// Alpha is never negative in a finished target. Between blocks, its sign tells whether the ray is inside the
// iso-surface. Magnitudes below this count as 0, because devices may lose the sign of 0.
const float MIN_ALPHA = 1e-30;

// Returns the state that earlier dispatches stored for a ray.
Kept resume(const RaycastParams params, uvec2 in_part, ivec2 texel)
{
    Kept kept = Kept(vec4(0.0), vec2(NO_SHELL, -1.0), 0u, false, false);
#ifdef KEEPS
    if (params.first_step > 0u && KEPT != KEPT_NOTHING) kept = kept_of(params, in_part);
#endif
    if (params.first_step > 0u && KEPT != KEPT_ALL) {
        kept.sum = imageLoad(color, texel);
        kept.is_inside = kept.sum.a < 0.0;
        kept.is_done = false;
        kept.sum.a = abs(kept.sum.a) > MIN_ALPHA ? abs(kept.sum.a) : 0.0;
    }
    return kept;
}

// Returns the range of a ray's steps for this dispatch. A ray that has waited continues at its own next step.
Block block_of(const RaycastParams params, const Lattice lattice, const Kept kept)
{
    if (KEPT != KEPT_ALL) return block_of(params, lattice);
    const uint steps = step_count(lattice);
    const uint ahead = kept.is_done ? 0u : min(params.end_step - params.first_step, steps - kept.step);
    Block block = Block(kept.step, kept.step + ahead, kept.step + ahead >= lattice.whole);
    if (block.is_last && block.end == lattice.whole && !kept.is_done) block.end = steps;
    return block;
}

// Returns the length along the ray at which a block ends.
float end_of_block(const RaycastParams params, const Lattice lattice, const Block block)
{
    return block.is_last ? lattice.end : step_begin(params, lattice.begin, block.end);
}

#ifdef SHELLED
// Draws crossings of the iso-surface. Crossings are rare, so this is outside the loops that search and sample.
void take_between_shells(const RaycastParams params, const Ray ray, const Lattice lattice, uint end_step,
                         inout Shell shell, inout March march, inout Work work)
{
    bool goes_on = march.i < end_step && march.sum.a < params.opacity_limit && !march.waits;
    if (goes_on) do {
        const float next_sample = middle_of(params, lattice, march.i);
        add_shells(params, ray, next_sample, shell, march.sum);
        march.waits = shell_waits(params, shell, next_sample, march.sum);
        take_samples(params, ray, lattice, end_step, known_until(shell), march, work);
        goes_on = march.i < end_step && march.sum.a < params.opacity_limit && !march.waits;
    } while (goes_on);
}

// Crossings behind the last sample.
void add_last_shells(const RaycastParams params, const Ray ray, inout Shell shell, inout March march)
{
    add_shells(params, ray, NO_SHELL, shell, march.sum);
    march.waits = shell_waits(params, shell, NO_SHELL, march.sum);
}
#endif

uint bricks_between(vec3 a, vec3 b)
{
    const ivec3 d = abs(ivec3(a) / int(BRICK_SIZE) - ivec3(b) / int(BRICK_SIZE));
    return uint(d.x + d.y + d.z) + 1u;
}

void count_work(const RaycastParams params, const Ray ray, const Lattice lattice, const Block block, const Work work,
                bool is_terminated)
{
    const float begin = step_begin(params, lattice.begin, min(block.first, lattice.whole));
    const float end = end_of_block(params, lattice, block);
    const uint crossed = bricks_between(position_at(params, ray, begin), position_at(params, ray, end));
    count(COUNTER_RAYS, uint(params.first_step == 0u));
    count(COUNTER_SAMPLES, work.samples);
    count(COUNTER_SHADED, work.shaded);
    count(COUNTER_DENSITY_READS, density_reads);
    count(COUNTER_LEAPS, work.leaps);
    count(COUNTER_TURNS, work.turns);
    count(COUNTER_BRICKS_VISITED, work.bricks);
    count(COUNTER_BRICKS_SKIPPED, crossed - min(work.bricks, crossed));
    count(COUNTER_TERMINATED, uint(is_terminated));
}

void main()
{
    const RaycastParams params = params_block.data;
    const uvec2 in_part = params.drawn_begin + thread_in_part();
    if (any(greaterThanEqual(in_part, params.drawn_end))) return;
    Span span;
    Ray ray = ray_of(params, params.pixel_begin + in_part, span);
    ray.half_way = half_way(params.light, ray.to_eye);
#ifdef SURFACED
    const vec4 surface = imageLoad(surfaces, ivec2(in_part));
    span.end = min(span.end, max(surface.a, span.begin));
#endif
    const ivec2 texel = ivec2(params.target + in_part);
    const Kept kept = resume(params, in_part, texel);
    const Lattice lattice = lattice_of(params, span.begin, span.end);
    const Block block = block_of(params, lattice, kept);
    March march = march_from(block.first, kept.sum);
    Work work = no_work();
#ifdef SHELLED
    Shell shell = begin_shell(params, ray, lattice, kept.is_done ? lattice.begin : end_of_block(params, lattice, block),
                              kept.shell, kept.is_inside);
    take_between_shells(params, ray, lattice, block.end, shell, march, work);
#else
    take_samples(params, ray, lattice, block.end, NO_SHELL, march, work);
#endif
    add_rest(params, lattice, march);
    march.i = min(march.i, step_count(lattice));   // leaps go beyond the end
    bool stops_short = is_cut_short(params, lattice, block, march) && !kept.is_done;
#ifdef SHELLED
    if (block.is_last && !march.waits && !kept.is_done) add_last_shells(params, ray, shell, march);
    stops_short = stops_short || shell.turns >= MAX_TURNS;
    work.turns += shell.turns;
#endif
    count(COUNTER_CUT_SHORT, uint(stops_short));
    const bool is_stopped = march.sum.a >= params.opacity_limit;
    const bool is_done = kept.is_done || is_stopped || (block.is_last && !march.waits);
    if (COUNT_WORK != 0u && lattice.end > lattice.begin) {
        const bool ends_here = KEPT == KEPT_ALL ? is_done && !kept.is_done : block.is_last;
        count_work(params, ray, lattice, block, work, ends_here && is_stopped);
    }
#ifdef SHELLED
    const Kept left = Kept(march.sum, vec2(shell.next, shell.from), march.i, shell.is_inside, is_done);
#else
    const Kept left = Kept(march.sum, kept.shell, march.i, false, is_done);
#endif
#ifdef KEEPS
    if (KEPT != KEPT_NOTHING) keep(params, in_part, left);
#endif
    if (!block.is_last && KEPT != KEPT_ALL) {
        if (left.is_inside) march.sum.a = -max(march.sum.a, MIN_ALPHA);
        imageStore(color, texel, march.sum);
        return;
    }
#ifdef SURFACED
    if (!is_stopped && surface.a < NO_SURFACE) accumulate(march.sum, vec4(surface.rgb, 1.0));
#endif
    imageStore(color, texel, over_background(params, march.sum));
}

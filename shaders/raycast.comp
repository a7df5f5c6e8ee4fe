// Emission-absorption ray-casting of a volume of bricks: one pixel per thread. Its variants differ in their bindings:
//   FILTERED   the atlas is sampled by the device's filter instead of exact arithmetic
//   MASKED     there is a segmentation mask; an unpainted volume binds and fetches none of it
//   PAGED      paged bricks of several levels (pages.h), instead of a leap grid over resident bricks
//   OCCLUDED   ambient light is scaled by the share that reaches the sample (occlusion.h)
//   SURFACED   rays end at opaque surfaces (surfaces.comp)
//   SHELLED    an iso-surface in the region around the probe (shell.glsl), which drivers would compile before they
//              drop it
// variants: PAGED FILTERED MASKED OCCLUDED SURFACED SHELLED
//
// Samples are in the middle of steps of equal length, on a lattice that starts where the ray enters the drawn box; the
// last, shorter step has its own sample. Leaps go from lattice point to lattice point, so pictures with and without
// skipping have the same bits. The number of steps is not limited: a long ray is drawn in blocks of steps, one dispatch
// each, because some devices silently abort a thread's loops after 65535 iterations. Between blocks the target holds a
// ray's accumulated colour. A ray that nevertheless stops short of its end is counted.
//
// If a ray passes more bricks than fit on the device, it waits (KEPT_ALL): it stops before a brick that is not on the
// device, marks it, and continues in a later dispatch. What it adds, and in which order, does not depend on where it
// stops.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "raycast.h"
#include "adaptive.h"
#ifdef PAGED
#include "pages.h"
#endif
#ifdef OCCLUDED
#include "occlusion/occlusion.h"
#endif
#ifdef SURFACED
#include "surfaces.h"
#endif

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(constant_id = 0) const uint SHADED = 1u;
layout(constant_id = 1) const uint COUNT_WORK = 0u;
// Rows of bricks lie along x in memory, so a wider group of pixels uses more of each cache line on devices whose images
// are linear.
layout(constant_id = 2) const uint GROUP_WIDTH = 8u;
layout(constant_id = 3) const uint SHININESS_SQUARINGS = NOT_A_POWER_OF_TWO;
// Stores the point of steepest opacity (voxel space) and the ray's opacity instead of a colour, or 0 if the rise is too
// small to be visible. The target has PICK_ROWS rows.
layout(constant_id = 4) const uint PICK = 0u;
// Records which bricks rays visit. Complete pictures do not need it.
layout(constant_id = 5) const uint FEEDBACK = 0u;
layout(constant_id = 6) const uint DISTANCE_BLEND = 0u;
// Draws one sample half-way along each ray, in grey, ignoring the transfer function.
layout(constant_id = 7) const uint SLICE = 0u;
// 1: classifies a step by the densities at both of its ends. 2: the same, and rays end at some densities.
layout(constant_id = 9) const uint PREINTEGRATED = 0u;
layout(constant_id = 10) const uint KEPT = KEPT_NOTHING;
// Assigns a sample to the group with the largest weight among the eight voxels around it, instead of the nearest
// voxel's.
layout(constant_id = 11) const uint SMOOTH_BORDERS = 0u;
#if !defined(PAGED) && !defined(FILTERED)
#define BITTED
layout(constant_id = 12) const uint HAS_SAMPLE_BITS = 0u;
#endif
layout(constant_id = 16) const uint BLOCKS_ALONE = 0u;   // draws only listed blocks of pixels (adaptive.h)
#ifdef SHELLED
layout(constant_id = 8) const uint SHELL = SHELL_BALL;   // the region's shape
layout(binding = 19, r32ui) uniform readonly uimage3D cell_ranges;   // minimum | maximum << 16
#endif

layout(binding = 0, scalar) readonly buffer Params { RaycastParams data; } params_block;
#ifndef PAGED
layout(binding = 1, r32ui) uniform readonly uimage3D leap;
#endif
#ifdef FILTERED
layout(binding = 2) uniform sampler3D atlas;
#else
layout(binding = 2, r32ui) uniform readonly uimage3D atlas;
#endif
// Tables are images, not buffers: one load for four components,
// and lavapipe would read a buffer one lane at a time.
// linear RGB (PREINTEGRATED: times opacity), opacity of a full step; then optical depths (raycast.h)
layout(binding = 3, rgba32f) uniform readonly image2D table;
layout(binding = 4, rgba32f) uniform image2D color;
#ifdef MASKED
layout(binding = 5, r8ui) uniform readonly uimage3D mask;
#define MASK_TABLE_BINDING 6
// By number: linear RGB, opacity of a full step; in the second row, the optical depth of a full step.
layout(binding = 7, rgba32f) uniform readonly image2D groups;
#endif

#ifdef OCCLUDED
// Light follows a curve of points instead of a power (occlusion.h).
layout(constant_id = 14) const uint OCCLUSION_MAPPED = 0u;
layout(binding = 10, r8ui) uniform readonly uimage3D occlusion;
layout(binding = 11, scalar) readonly buffer Look { OcclusionLook data; OcclusionSegment segments[]; } occlusion_look;
#endif
#ifdef SURFACED
layout(binding = 12, rgba32f) uniform readonly image2D surfaces;   // linear RGB, length along the ray
#endif

#ifdef BITTED
layout(binding = 14, r32ui) uniform readonly uimage3D sample_bits;   // leap.h
#endif

#if defined(PAGED) || defined(SHELLED)
#define KEEPS
layout(binding = 13, rgba32f) uniform image2D rays;   // raycast.h, KEPT; without it, one texel

// The second half of a ray's state is stored below the first.
ivec2 beside(const RaycastParams params, uvec2 in_part)
{
    return ivec2(in_part.x, in_part.y + (params.pixel_end.y - params.pixel_begin.y));
}
#endif

#include "library/rays.glsl"
#define LISTED_BLOCKS_BINDING 20
#include "library/listed_blocks.glsl"
#include "library/counters.glsl"
#ifdef MASKED
#ifdef PAGED
#define MASK_TABLE_HASHED
#endif
#include "library/mask.glsl"
#endif
uint density_reads = 0u;
#ifdef PAGED
#define STACKED 16
#endif
#ifdef FILTERED
#include "library/density_filtered.glsl"
#else
#include "library/density_exact.glsl"
#endif
#include "library/shade.glsl"
#ifdef OCCLUDED
#include "occlusion/occlusion.glsl"
#endif

#ifdef PAGED
#include "library/pages.glsl"
#else
// The region that contains a position: one with nothing visible (distance > 0), or a brick.
struct Place {
    uint distance;   // in cells
    uint slot;
    bool is_painted;  // perhaps
    bool is_missing;  // never
};

Place place_at(const RaycastParams params, vec3 position)
{
    const uint entry = imageLoad(leap, ivec3(uvec3(position) / CELL_SIZE)).x;
    return Place(entry >> LEAP_DISTANCE_SHIFT, entry & LEAP_SLOT_MASK, (entry & LEAP_PAINTED) != 0u, false);
}
#endif

// Limit of a leap in steps: from the last step (library/lattice.glsl) it still ends at a number of 32 bits.
const float MAX_LEAP = 2147483648.0;
const float NO_SHELL = 1e30;   // a length along a ray
// Lanes that have seen nothing in this many consecutive samples search for the next visible one: soon if the previous
// search was long, late if nearly every sample is visible, since all lanes wait while one searches.
const uint AWAY_FROM_SEEN = 64u;
const uint SAMPLES_OF_LEAP = 8u;   // counted as unseen
const uint LITTLE_PATIENCE = 2u;
const uint MUCH_PATIENCE = 64u;
// A target's alpha is never negative; between blocks its sign says whether the ray is inside the iso-surface. Smaller
// values count as 0, whose sign devices may lose.
const float LEAST_ALPHA = 1e-30;

struct Ray {
    vec3 origin;      // voxel space, at length 0
    vec3 direction;   // voxels per reference length
    vec3 inverse;     // 1 / direction; a large number if the direction is 0
    vec3 ahead;       // 1 if the direction is positive, else 0
    vec3 half_way;    // unit, between the directions to the eye and to the light; 0 where they are opposite
};

struct Work {
    uint samples, shaded, leaps, bricks, turns;
    uint last_slot;
    uint last_entry;
};

#include "library/sample.glsl"
#include "library/lattice.glsl"

void note_sample(const Place place, inout Work work)
{
    ++work.samples;
    work.bricks += uint(place.slot != work.last_slot);
    work.last_slot = place.slot;
}

// Counts a sample, which is also shaded if any is.
void note_taken(const Place place, inout Work work)
{
    note_sample(place, work);
    work.shaded += uint(SHADED != 0u);
}

// The number of whole steps from `position` that stay inside the empty cube around its cell.
uint steps_to_leave(const RaycastParams params, const Ray ray, vec3 position, const Place place)
{
    const float reach = float(place.distance);
#ifdef PAGED
    const vec3 cell = vec3(uvec3(position) >> place.cell_shift);
    const vec3 box = vec3(uvec3(position) >> place.box_shift);
    const float cell_size = float(1u << place.cell_shift), box_size = float(1u << place.box_shift);
    // A brick's data is valid only inside that brick.
    const vec3 bound = clamp(cell_size * (cell + mix(vec3(1.0 - reach), vec3(reach), ray.ahead)), box_size * box,
                             box_size * (box + 1.0));
#else
    const vec3 cell = vec3(uvec3(position) / CELL_SIZE);
    const vec3 bound = float(CELL_SIZE) * (cell + mix(vec3(1.0 - reach), vec3(reach), ray.ahead));
#endif
    const vec3 lengths = (bound - position) * ray.inverse;
    const float exit = min(lengths.x, min(lengths.y, lengths.z));
    // The guard keeps rays from leaping over a sample that rounding puts on the border.
    const float steps = exit / params.step - 0.01;
    return 1u + (steps > 0.0 && steps < MAX_LEAP ? uint(steps) : 0u);   // not for NaN
}

void note(const Place place, inout Work work)
{
#ifdef PAGED
    const bool is_wanted = KEPT != KEPT_ALL || place.is_missing;
    if (FEEDBACK != 0u && is_wanted && place.entry != work.last_entry) {
        note_reached(place);
        work.last_entry = place.entry;
    }
#endif
}

// The single sample of a slice. It is shown even if the transfer function hides it, but not outside the view.
vec4 sliced(const RaycastParams params, const Ray ray, vec3 position, inout Work work, out bool waits)
{
    Place place = place_at(params, position);
    note(place, work);
    waits = place.is_missing;
#ifdef PAGED
    if (place.distance > 0u || waits) return vec4(0.0);
#endif
    if (COUNT_WORK != 0u) note_taken(place, work);
    return sample_at(params, ray, position, 1.0, place, vec2(0.0)).look;
}

void accumulate(inout vec4 sum, vec4 look)
{
    const float weight = (1.0 - sum.a) * look.a;
    sum.rgb += weight * look.rgb;
    sum.a += weight;
}

#include "library/pick.glsl"
#include "library/search.glsl"

void add(const RaycastParams params, vec4 look, float middle, inout vec4 sum, inout Rises rises)
{
    if (PICK != 0u) note_rise(rises, (1.0 - sum.a) * look.a, look.a, middle);
    accumulate(sum, look);
}

// A ray's accumulated state, and its position.
struct March {
    uint i;        // the next step: the whole ones, then the rest; beyond that, none
    vec4 sum;
    Rises rises;
    uint unseen;   // consecutive samples that showed nothing
    bool waits;    // for a brick
    bool has_rest;
    Sample rest;   // the sample found there, not added yet
};

// Adds samples from step `march.i` on, up to `until`, a length along the ray, or to `end_step`; the rest of the ray
// after its whole steps counts as a step, and is found here and added by the caller: its opacity takes loads that no
// whole step needs.
//
// SIMD devices run both sides of a branch for all their lanes, so the cheap part, the search for a visible sample, and
// the costly part are separate loops, in which lanes stay together as long as it pays.
void take_samples(const RaycastParams params, const Ray ray, const Lattice lattice, uint end_step, float until,
                  inout March march, inout Work work)
{
    const uint first = march.i;   // always taken, whatever rounding makes of `until`
    bool is_behind = false;
    bool searches_on = march.i < end_step && march.sum.a < params.opacity_limit && !march.waits;
    if (searches_on) do {
        const uint step_before = march.i;
        search_sample(params, ray, lattice.begin, min(end_step, lattice.whole), march.i, march.unseen, work);
        const uint patience = march.unseen >= AWAY_FROM_SEEN ? LITTLE_PATIENCE : MUCH_PATIENCE;
        if (march.i > step_before) march.rises.trough = 0.0;
        march.unseen = 0u;
        // A step's density at its beginning is that at the end of the previous one, if that is in a brick of its level.
        const uint run = march.i;
        float front = 0.0;
        uint level = 0u;
        if (PREINTEGRATED != 0u) {
            const vec3 position = position_at(params, ray, middle_of(params, lattice, run));
            const Place place = place_at(params, position);
            front = value_at_end(params, ray, step_begin(params, lattice.begin, run), texels_at(position, place),
                                 place);
        }
        bool goes_on;
        do {
            const float middle = middle_of(params, lattice, march.i);
            const vec3 position = position_at(params, ray, middle);
            const Place place = place_at(params, position);
            note(place, work);
            if (COUNT_WORK != 0u) ++work.turns;
#ifdef SHELLED
            is_behind = is_behind || (march.i != first && middle > until);
#endif
            goes_on = place.distance == 0u && march.i < end_step && march.sum.a < params.opacity_limit && !is_behind;
#ifdef PAGED
            level = march.i == run ? place.level : level;
            goes_on = goes_on && (PREINTEGRATED == 0u || place.level == level);
#endif
            march.waits = march.waits || (goes_on && place.is_missing && march.sum.a < params.opacity_limit);
            if (goes_on && !march.waits) {
                const bool is_rest = march.i == lattice.whole;
                vec2 ends = vec2(front, 0.0);
                if (PREINTEGRATED != 0u)
                    ends.y = value_at_end(params, ray, end_of(params, lattice, march.i), texels_at(position, place),
                                          place);
                front = ends.y;
                const float part = is_rest ? lattice.part : 1.0;
                const Sample found = sample_at(params, ray, position, part, place, ends);
                if (COUNT_WORK != 0u) note_taken(place, work);
                if (is_rest) {
                    march.rest = found;
                    march.has_rest = true;
                } else {
                    add(params, found.look, middle, march.sum, march.rises);
                    march.unseen = found.look.a > 0.0 ? 0u : march.unseen + 1u;
                }
                ++march.i;
            }
            goes_on = goes_on && !march.waits && march.i < end_step && march.unseen < patience &&
                      march.sum.a < params.opacity_limit;
        } while (goes_on);
        // Drivers may round positions in one loop differently from the other, and the two then disagree about a border.
        march.i += uint(march.i == step_before && !march.waits && !is_behind);
        if (COUNT_WORK != 0u) ++work.turns;
        searches_on = march.i < end_step && march.sum.a < params.opacity_limit && !march.waits && !is_behind;
    } while (searches_on);
}

#ifdef SHELLED
#include "library/shell.glsl"
#endif

uint bricks_between(vec3 a, vec3 b)
{
    const ivec3 d = abs(ivec3(a) / int(BRICK_SIZE) - ivec3(b) / int(BRICK_SIZE));
    return uint(d.x + d.y + d.z) + 1u;
}

void main()
{
    const RaycastParams params = params_block.data;
    const uvec2 in_part = BLOCKS_ALONE != 0u ? listed_in_part(params.pixel_begin, params.pixel_end)
                                          : params.drawn_begin + thread_in_part();
    if (any(greaterThanEqual(in_part, params.drawn_end))) return;
    const uvec2 pixel = params.pixel_begin + in_part;

    const vec2 centre = vec2(pixel) + 0.5;
    const vec3 near = on_plane(params.near_corner, params.near_dx, params.near_dy, centre);
    const vec3 far = on_plane(params.far_corner, params.far_dx, params.far_dy, centre);
    const vec3 physical = (far - near) * params.spacing;
    const float length_to_far = length(physical);
    Ray ray;
    ray.origin = near;
    ray.direction = (far - near) / length_to_far;
    ray.half_way = half_way(params.light, -physical / length_to_far);
    const bvec3 still = equal(ray.direction, vec3(0.0));
    ray.inverse = mix(1.0 / ray.direction, vec3(1e30), still);
    ray.ahead = vec3(greaterThanEqual(ray.direction, vec3(0.0)));

    // Slabs; an axis along which the ray does not move is an inside test (0 / 0 does not matter there).
    const vec3 a = (params.box_lower - near) / ray.direction;
    const vec3 b = (params.box_upper - near) / ray.direction;
    const vec3 entry = mix(min(a, b), vec3(0.0), still);
    const vec3 exit = mix(max(a, b), vec3(length_to_far), still);
    const bool misses = any(bvec3(still.x && (near.x < params.box_lower.x || near.x > params.box_upper.x),
                                  still.y && (near.y < params.box_lower.y || near.y > params.box_upper.y),
                                  still.z && (near.z < params.box_lower.z || near.z > params.box_upper.z)));
    const float begin = max(max(entry.x, entry.y), max(entry.z, 0.0));
    float end = misses ? begin : min(min(exit.x, exit.y), min(exit.z, length_to_far));
#ifdef SURFACED
    const vec4 surface = imageLoad(surfaces, ivec2(in_part));
    end = min(end, max(surface.a, begin));
#endif

    const ivec2 texel = ivec2(params.target + in_part);
    March march = March(0u, vec4(0.0), Rises(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), AWAY_FROM_SEEN, false, false,
                        Sample(vec4(0.0), 0.0, 0u));
    bool begins_inside = false;   // of the iso-surface
    if (params.first_step > 0u && KEPT != KEPT_ALL) {
        march.sum = imageLoad(color, texel);
        begins_inside = march.sum.a < 0.0;
        march.sum.a = abs(march.sum.a) > LEAST_ALPHA ? abs(march.sum.a) : 0.0;
        if (PICK != 0u && march.sum.a >= params.opacity_limit) return;   // the point found stays
        if (PICK != 0u) {
            const vec4 runs = imageLoad(color, texel + ivec2(0, 1)), run = imageLoad(color, texel + ivec2(0, 2));
            march.rises = Rises(runs.x, runs.y, runs.z, runs.w, run.x, run.y, run.z);
        }
    }
    vec4 kept = vec4(NO_SHELL, -1.0, 0.0, 0.0);
    uint state = 0u;
#ifdef KEEPS
    if (params.first_step > 0u && KEPT != KEPT_NOTHING) kept = imageLoad(rays, ivec2(in_part));
    if (params.first_step > 0u && KEPT == KEPT_ALL) {
        march.sum = imageLoad(rays, beside(params, in_part));
        state = uint(kept.w) >> 16u;
        begins_inside = (state & RAY_IS_INSIDE) != 0u;
    }
#endif
    const bool was_done = (state & RAY_IS_DONE) != 0u;
    Work work = Work(0u, 0u, 0u, 0u, 0u, 0u, 0xffffffffu);
    if (SLICE != 0u && !was_done) {
        const float plane = 0.5 * length_to_far;
        if (begin <= plane && plane <= end)
            march.sum = sliced(params, ray, position_at(params, ray, plane), work, march.waits);
    }
    if (SLICE != 0u) end = begin;

    const Lattice lattice = lattice_of(params, begin, end);
    const uint steps = step_count(lattice);
    uint first_step = min(params.first_step, lattice.whole), end_step = min(params.end_step, lattice.whole);
    bool is_last = params.is_last_block != 0u;
    if (KEPT == KEPT_ALL) {
        first_step = uint(kept.z) + ((uint(kept.w) & 0xffffu) << 16u);
        end_step = first_step + (was_done ? 0u : min(params.end_step - params.first_step, steps - first_step));
        is_last = end_step >= lattice.whole;
    }
    if (is_last && end_step == lattice.whole && !was_done) end_step = steps;
    const float block_begin = step_begin(params, begin, min(first_step, lattice.whole));
    const float block_end = is_last ? end : step_begin(params, begin, end_step);

#ifdef SHELLED
    Shell shell = begin_shell(params, ray, begin, end, was_done ? begin : block_end, kept, begins_inside);
#endif

    march.i = first_step;
#ifdef SHELLED
    // Crossings are few, and drawn outside the loops that search for samples and take them.
    bool goes_on = march.i < end_step && march.sum.a < params.opacity_limit && !march.waits;
    if (goes_on) do {
        const float next_sample = middle_of(params, lattice, march.i);
        add_shells(params, ray, next_sample, shell, march.sum);
        march.waits = shell_waits(params, shell, next_sample, march.sum);
        take_samples(params, ray, lattice, end_step, known_until(shell), march, work);
        goes_on = march.i < end_step && march.sum.a < params.opacity_limit && !march.waits;
    } while (goes_on);
#else
    take_samples(params, ray, lattice, end_step, NO_SHELL, march, work);
#endif
    if (march.has_rest) {
        const float opacity = opacity_of_rest(params, march.rest, lattice.part);
        add(params, vec4(march.rest.look.rgb, opacity), lattice.rest_middle, march.sum, march.rises);
    }
    march.i = min(march.i, steps);   // leaps may go beyond the end
    // Only the device ends the loop before its end; and the last block may end before the ray.
    bool is_cut_short = march.i < (is_last ? steps : end_step) && march.sum.a < params.opacity_limit &&
                        !march.waits && !was_done;

#ifdef SHELLED
    if (is_last && !march.waits && !was_done) {
        add_shells(params, ray, NO_SHELL, shell, march.sum);
        march.waits = shell_waits(params, shell, NO_SHELL, march.sum);
    }
    is_cut_short = is_cut_short || shell.turns >= MAX_TURNS;
    work.turns += shell.turns;
#endif
    count(COUNTER_CUT_SHORT, uint(is_cut_short));
    const bool is_stopped = march.sum.a >= params.opacity_limit;
    const bool is_done = was_done || is_stopped || (is_last && !march.waits);

    if (COUNT_WORK != 0u && end > begin) {
        const uint crossed = bricks_between(position_at(params, ray, block_begin), position_at(params, ray, block_end));
        count(COUNTER_RAYS, uint(params.first_step == 0u));
        count(COUNTER_SAMPLES, work.samples);
        count(COUNTER_SHADED, work.shaded);
        count(COUNTER_DENSITY_READS, density_reads);
        count(COUNTER_LEAPS, work.leaps);
        count(COUNTER_TURNS, work.turns);
        count(COUNTER_BRICKS_VISITED, work.bricks);
        count(COUNTER_BRICKS_SKIPPED, crossed - min(work.bricks, crossed));
        const bool ends_here = KEPT == KEPT_ALL ? is_done && !was_done : is_last;
        count(COUNTER_TERMINATED, uint(ends_here && is_stopped));
    }

#ifdef KEEPS
    if (KEPT != KEPT_NOTHING) {
#ifdef SHELLED
        kept.xy = vec2(shell.next, shell.from);
        state = shell.is_inside ? RAY_IS_INSIDE : 0u;
#else
        state = 0u;
#endif
        state |= is_done ? RAY_IS_DONE : 0u;
        imageStore(rays, ivec2(in_part), vec4(kept.xy, float(march.i & 0xffffu), float(march.i >> 16u | state << 16u)));
        if (KEPT == KEPT_ALL) imageStore(rays, beside(params, in_part), march.sum);
    }
#endif
    if (!is_last && KEPT != KEPT_ALL && (PICK == 0u || !is_stopped)) {
#ifdef SHELLED
        if (shell.is_inside) march.sum.a = -max(march.sum.a, LEAST_ALPHA);
#endif
        imageStore(color, texel, march.sum);
        if (PICK != 0u) {
            const Rises rises = march.rises;
            imageStore(color, texel + ivec2(0, 1), vec4(rises.most, rises.most_at, rises.run, rises.steepest));
            imageStore(color, texel + ivec2(0, 2), vec4(rises.steepest_at, rises.peak, rises.trough, 0.0));
        }
        return;
    }
    vec3 seen = position_at(params, ray, march.rises.most_at);
#ifdef SURFACED
    if (!is_stopped && surface.a < NO_SURFACE) {
        if (PICK != 0u && 1.0 - march.sum.a > march.rises.most) {
            march.rises.most = 1.0 - march.sum.a;
            seen = ray.origin + surface.a * ray.direction;  // may be outside the volume
        }
        accumulate(march.sum, vec4(surface.rgb, 1.0));
    }
#endif

    if (PICK != 0u) {
        imageStore(color, texel, march.rises.most >= LEAST_SEEN ? vec4(seen, march.sum.a) : vec4(0.0));
        return;
    }
    const float through = (1.0 - march.sum.a) * params.background.a;
    imageStore(color, texel, vec4(march.sum.rgb + through * params.background.rgb, march.sum.a + through));
}

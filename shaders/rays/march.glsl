// Marching along a ray: samples lie in the middle of steps of equal length, on a lattice that starts where the ray
// enters the drawn box; the last, shorter step has its own sample. Leaps go from lattice point to lattice point, so
// pictures with and without skipping have the same bits. The number of steps is unlimited: a long ray is drawn in
// blocks of steps, one dispatch each, because some devices silently end a thread's loops after 65535 iterations.
//
// COMPENSATED: sums are compensated, since rounding errors would otherwise add up over many short steps.
//
// Needs volume.glsl, ray.glsl, the constants SHADED, COUNT_WORK, FEEDBACK, PREINTEGRATED, SMOOTH_BORDERS and
// DISTANCE_BLEND, and library/shade.glsl if SHADED may be 1. PICKS: notes how the opacity rises along the ray.
#ifdef PICKS
#include "../library/pick.glsl"
#endif

#if !defined(PAGED) && !defined(FILTERED) && !defined(INTEGRATED)
#define BITTED
layout(constant_id = 12) const uint HAS_SAMPLE_BITS = 0u;
layout(binding = 14, r32ui) uniform readonly uimage3D sample_bits;   // leap.h
#endif
#ifdef INTEGRATED
const uint COMPENSATED = 1u;
#else
layout(constant_id = 17) const uint COMPENSATED = 0u;
#endif
// Linear RGB (PREINTEGRATED: times opacity) and opacity of a full step, followed by optical depths (raycast.h).
layout(binding = 3, rgba32f) uniform readonly image2D table;

// Maximum steps of a leap: even a leap from the last step (library/lattice.glsl) keeps the index within 32 bits.
const float MAX_LEAP = 2147483648.0;
const float NO_SHELL = 1e30;   // a length along a ray
// A lane searches for the next visible sample after this number of consecutive invisible samples: LITTLE_PATIENCE after
// a long search, MUCH_PATIENCE if most samples are visible, since all lanes wait while one lane searches.
const uint AWAY_FROM_SEEN = 64u;
const uint SAMPLES_OF_LEAP = 8u;   // counted as unseen
const uint LITTLE_PATIENCE = 2u;
const uint MUCH_PATIENCE = 64u;

struct Work {
    uint samples, shaded, leaps, bricks, turns;
    uint last_slot;
    uint last_entry;
};

Work no_work()
{
    return Work(0u, 0u, 0u, 0u, 0u, 0u, 0xffffffffu);
}

#include "../library/sample.glsl"
#include "../library/lattice.glsl"

// Counts a sample if it is taken. The last slot is assigned without a branch, because SwiftShader loses values that a
// lane sets in a branch of a loop if the lane leaves the loop before the others.
void note_sample(bool is_taken, const Place place, inout Work work)
{
    work.samples += uint(is_taken);
    work.bricks += uint(is_taken && place.slot != work.last_slot);
    work.last_slot = is_taken ? place.slot : work.last_slot;
}

// Counts a sample that is taken; if SHADED, also counts it as shaded.
void note_taken(const Place place, inout Work work)
{
    note_sample(true, place, work);
    work.shaded += uint(SHADED != 0u);
}

// Returns the number of whole steps from `position` that stay inside the empty cube around its cell.
uint steps_to_leave(const RaycastParams params, const Ray ray, vec3 position, const Place place)
{
    const float reach = float(place.distance);
#ifdef PAGED
    const vec3 cell = vec3(to_uint(position) >> place.cell_shift);
    const vec3 box = vec3(to_uint(position) >> place.box_shift);
    const float cell_size = float(1u << place.cell_shift), box_size = float(1u << place.box_shift);
    // A brick's leap distances are valid only inside that brick.
    const vec3 bound = clamp(cell_size * (cell + mix(vec3(1.0 - reach), vec3(reach), ray.ahead)), box_size * box,
                             box_size * (box + 1.0));
#else
    const vec3 cell = vec3(to_uint(position) / CELL_SIZE);
    const vec3 bound = float(CELL_SIZE) * (cell + mix(vec3(1.0 - reach), vec3(reach), ray.ahead));
#endif
    const vec3 lengths = (bound - position) * ray.inverse;
    const float exit = min(lengths.x, min(lengths.y, lengths.z));
    // The margin of 0.01 steps ensures that rays do not leap over a sample on the border because of rounding.
    const float steps = exit / params.step - 0.01;
    return 1u + (steps > 0.0 && steps < MAX_LEAP ? uint(steps) : 0u);   // not for NaN
}

void note(const Place place, inout Work work)
{
#ifdef PAGED
    const bool is_wanted = (KEPT != KEPT_ALL || place.is_missing) && place.entry != work.last_entry;
    if (FEEDBACK != 0u && is_wanted) note_reached(place);
    work.last_entry = is_wanted ? place.entry : work.last_entry;   // carried, as the slot
#endif
}

void accumulate(inout vec4 sum, vec4 look)
{
    const float weight = (1.0 - sum.a) * look.a;
    sum.rgb += weight * look.rgb;
    sum.a += weight;
}

// Like accumulate(), but with compensated sums (Kahan 1965). `above`: excess of the sum over its exact value.
void accumulate_compensated(inout vec4 sum, inout vec4 above, vec4 look)
{
    const float weight = ((1.0 - sum.a) + above.a) * look.a;
    precise const vec4 added = vec4(weight * look.rgb, weight) - above;
    precise const vec4 next = sum + added;
    precise const vec4 rounded = (next - sum) - added;
    above = rounded;
    sum = next;
}

#ifndef INTEGRATED
#include "../library/search.glsl"
#endif

// A ray's accumulated state, and its position.
struct March {
    uint i;        // index of the next step: whole steps first, then the shorter last step, then the end
    vec4 sum;
    vec4 above;    // accumulate_compensated(), since the dispatch began
#ifdef PICKS
    Rises rises;
#endif
    uint unseen;   // consecutive samples that showed nothing
    bool waits;    // for a brick
    bool has_rest;
    Sample rest;   // sample of the shorter last step, before it is added
};

// Starts a march at `step`, with the sum gathered by earlier dispatches.
March march_from(uint step, vec4 sum)
{
    March march;
    march.i = step;
    march.sum = sum;
    march.above = vec4(0.0);
#ifdef PICKS
    march.rises = Rises(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
#endif
    march.unseen = AWAY_FROM_SEEN;
    march.waits = march.has_rest = false;
    march.rest = Sample(vec4(0.0), 0.0, 0u);
    return march;
}

void add(vec4 look, float middle, inout March march)
{
#ifdef PICKS
    note_rise(march.rises, (1.0 - march.sum.a) * look.a, look.a, middle);
#endif
    if (COMPENSATED != 0u)
        accumulate_compensated(march.sum, march.above, look);
    else
        accumulate(march.sum, look);
}

#ifdef INTEGRATED
#include "integral.glsl"
#else
// Returns the density at the beginning of a step.
float value_at_begin(const RaycastParams params, const Ray ray, const Lattice lattice, uint step)
{
    const vec3 position = position_at(params, ray, middle_of(params, lattice, step));
    const Place place = place_at(params, position);
    return value_at_end(params, ray, step_begin(params, lattice.begin, step), texels_at(position, place), place);
}

// Takes the sample of step `march.i`, whose middle is at `position`. `front`: on entry, the density at the step's
// beginning; on return, the density at its end.
void take_sample(const RaycastParams params, const Ray ray, const Lattice lattice, vec3 position, const Place place,
                 inout float front, inout March march, inout Work work)
{
    const bool is_rest = march.i == lattice.whole;
    vec2 ends = vec2(front, 0.0);
    if (PREINTEGRATED != 0u)
        ends.y = value_at_end(params, ray, end_of(params, lattice, march.i), texels_at(position, place), place);
    front = ends.y;
    const float part = is_rest ? lattice.part : 1.0;
    const Sample found = sample_at(params, ray, position, part, place, ends);
    if (COUNT_WORK != 0u) note_taken(place, work);
    march.has_rest = march.has_rest || is_rest;
    march.rest.look = is_rest ? found.look : march.rest.look;
    march.rest.density = is_rest ? found.density : march.rest.density;
    march.rest.group = is_rest ? found.group : march.rest.group;
    if (!is_rest) {
        add(found.look, middle_of(params, lattice, march.i), march);
        march.unseen = found.look.a > 0.0 ? 0u : march.unseen + 1u;
    }
    ++march.i;
}

// Adds samples from step `march.i` on, up to the length `until` along the ray, or up to `end_step`. The ray's shorter
// last step is also sampled here, but the caller adds its sample (add_rest), because its opacity requires loads that
// whole steps do not need.
//
// SIMD devices run both sides of a branch for all lanes. So the cheap search for a visible sample and the costly
// sampling are separate loops, in which lanes stay together as long as this saves time.
void take_samples(const RaycastParams params, const Ray ray, const Lattice lattice, uint end_step, float until,
                  inout March march, inout Work work)
{
    const uint first = march.i;   // the first step is always taken, even if `until` is rounded to before it
    bool is_behind = false;
    bool searches_on = march.i < end_step && march.sum.a < params.opacity_limit && !march.waits;
    if (searches_on) do {
        const uint step_before = march.i;
        search_sample(params, ray, lattice.begin, min(end_step, lattice.whole), march.i, march.unseen, work);
        const uint patience = march.unseen >= AWAY_FROM_SEEN ? LITTLE_PATIENCE : MUCH_PATIENCE;
#ifdef PICKS
        march.rises.trough = march.i > step_before ? 0.0 : march.rises.trough;
#endif
        march.unseen = searches_on ? 0u : march.unseen;
        // If the end of a step is in a brick of the same level, the next step begins with the density at that end.
        const uint run = march.i;
        float front = PREINTEGRATED != 0u ? value_at_begin(params, ray, lattice, run) : 0.0;
        uint level = 0u;
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
                take_sample(params, ray, lattice, position, place, front, march, work);
            }
            goes_on = goes_on && !march.waits && march.i < end_step && march.unseen < patience &&
                      march.sum.a < params.opacity_limit;
        } while (goes_on);
        // The two loops may round a border differently, so that neither loop advances: this line then forces a step.
        march.i += uint(march.i == step_before && !march.waits && !is_behind);
        if (COUNT_WORK != 0u) ++work.turns;
        searches_on = march.i < end_step && march.sum.a < params.opacity_limit && !march.waits && !is_behind;
    } while (searches_on);
}

#endif

// Adds the sample of the ray's shorter last step, taken by take_samples().
void add_rest(const RaycastParams params, const Lattice lattice, inout March march)
{
    if (march.has_rest) {
        const float opacity = opacity_of_rest(params, march.rest, lattice.part);
        add(vec4(march.rest.look.rgb, opacity), lattice.rest_middle, march);
    }
}

// The range of a ray's steps that one dispatch takes.
struct Block {
    uint first, end;
    bool is_last;
};

Block block_of(const RaycastParams params, const Lattice lattice)
{
    Block block = Block(min(params.first_step, lattice.whole), min(params.end_step, lattice.whole),
                        params.is_last_block != 0u);
    if (block.is_last && block.end == lattice.whole) block.end = step_count(lattice);
    return block;
}

// Returns whether the device ended the loop too early. The last block counts as reaching the end of the ray.
bool is_cut_short(const RaycastParams params, const Lattice lattice, const Block block, const March march)
{
    return march.i < (block.is_last ? step_count(lattice) : block.end) && march.sum.a < params.opacity_limit &&
           !march.waits;
}

// Searches for the next visible sample. In noise near the threshold, few cells are empty and few samples show anything.
// So only densities are read, several samples at a time, before a sample is shaded. Needs raycast.comp's Ray, Place,
// Work and texels_at.
//
// Lanes that leave a loop early wait for the other lanes, and lavapipe loses values that such a lane has set in the
// loop. Therefore only the step and counts, which are incremented, survive these loops; the sample found is read
// again.
#include "to_int.glsl"

// Maximum iterations; lanes that have found nothing by then take a sample like the other lanes.
const uint MAX_SEARCH_TURNS = 20u;
// Whether the sample at `position` may show anything. A painted sample may, regardless of its density. So may every
// step that is classified by the densities at its ends, which the density at its middle does not bound.
bool may_be_seen(const RaycastParams params, vec3 position, const Place place)
{
    if (PREINTEGRATED != 0u) return true;
    const Texels texels = texels_at(position, place);
    const float density = value_of(density_at(texels.corner + texels.to_atlas, texels.fraction));
    return place.is_painted || (density >= params.table_lower && density <= params.table_upper);
}

#ifdef BITTED
// With sample bits (leap.h), samples cost one load each until a sample may show something.

// Leaps are repeated only while more than this many cells around are empty. In noise, nearly all leaps are short.
const uint NEAR = 1u;

// Number of samples per iteration that are read after a set bit: in noise above a threshold, set bits are clustered.
const uint ASKED_IN_TURN = 2u;

// The bits of the samples from step `i` on; the lowest bit is that of step `i`. Positions are in fixed point (leap.h),
// which is much cheaper: with the axes scaled, the lowest bits of x, y and z lie next to each other and form the bit's
// index.
uint bits_ahead(const RaycastParams params, const Ray ray, float begin, uint i)
{
    const vec3 parts = vec3(SAMPLE_BIT_PARTS, SAMPLE_BIT_PARTS << 2, SAMPLE_BIT_PARTS << 4);
    const uvec3 last = (to_uint(params.position_limit) + 1u) * uvec3(parts) - 1u;
    const uvec3 ahead = uvec3(ivec3(round(ray.direction * (params.step * parts))));
    uvec3 place = uvec3(ivec3((sample_position(params, ray, begin, i) + 0.5) * parts));
    uint found = 0u;
    [[unroll]] for (uint k = 0u; k < SAMPLE_BITS_AHEAD; ++k) {
        const uvec3 held = min(place, last);   // a ray may leave the volume; bits of samples outside are not used
        const uint bits = imageLoad(sample_bits, ivec3(held / (uvec3(parts) * uvec3(4u, 4u, 2u)))).x;
        const uint bit = (held.x & 3u * uint(parts.x) | held.y & 3u * uint(parts.y) | held.z & uint(parts.z)) /
                         SAMPLE_BIT_PARTS;
        found |= (bits >> bit & 1u) << k;
        place += ahead;
    }
    return found;
}

// As search_sample.
void search_bits(const RaycastParams params, const Ray ray, float begin, uint end_step, inout uint i,
                 inout uint unseen, inout Work work)
{
    uint turn = 0u;
    bool searches;
    do {
        bool leaps_on;
        do {
            const vec3 position = sample_position(params, ray, begin, i);
            const Place place = place_at(params, position);
            leaps_on = place.distance > NEAR && i < end_step;
            if (COUNT_WORK != 0u) ++work.turns;
            if (place.distance > 0u && i < end_step) {
                i += steps_to_leave(params, ray, position, place);
                unseen += SAMPLES_OF_LEAP;
                if (COUNT_WORK != 0u) ++work.leaps;
            }
        } while (leaps_on);
        uint found = bits_ahead(params, ray, begin, i), passed = SAMPLE_BITS_AHEAD;
        const uint from = i;
        searches = i < end_step;
        [[unroll]] for (uint k = 0u; k < ASKED_IN_TURN; ++k) {
            const uint next = uint(max(findLSB(found), 0));
            const vec3 position = sample_position(params, ray, begin, from + next);
            const Place place = place_at(params, position);
            const bool asks = searches && found != 0u && from + next < end_step && place.distance == 0u;
            const bool is_seen = asks && may_be_seen(params, position, place);
            if (COUNT_WORK != 0u) note_sample(asks && !is_seen, place, work);
            passed = is_seen ? next : passed;
            searches = searches && !is_seen;
            found &= found - 1u;
        }
        if (searches && found != 0u) passed = uint(findLSB(found));
        if (i < end_step) {
            i = min(i + passed, end_step);
            unseen += passed;
        }
        searches = searches && i < end_step;
        ++turn;
        if (COUNT_WORK != 0u) ++work.turns;
    } while (searches && i < end_step && turn < MAX_SEARCH_TURNS);
}
#endif

// Advances to a step whose sample may be visible, to the first step at which the search has to stop, or to `end_step`.
// `unseen` counts samples that show nothing.
void search_sample(const RaycastParams params, const Ray ray, float begin, uint end_step, inout uint i,
                   inout uint unseen, inout Work work)
{
#ifdef BITTED
    if (HAS_SAMPLE_BITS != 0u && PREINTEGRATED == 0u) {
        search_bits(params, ray, begin, end_step, i, unseen, work);
        return;
    }
#endif
    uint turn = 0u;
    bool searches;
    do {
        bool leaps;
        do {
            const vec3 position = sample_position(params, ray, begin, i);
            const Place place = place_at(params, position);
            if (i < end_step) note(place, work);
            leaps = place.distance > 0u && i < end_step;
            if (COUNT_WORK != 0u) ++work.turns;
            if (leaps) {
                i += steps_to_leave(params, ray, position, place);
                unseen += SAMPLES_OF_LEAP;
                if (COUNT_WORK != 0u) ++work.leaps;
            }
        } while (leaps);
        searches = i < end_step;
        if (searches) {
            bool is_found = false;
            uint passed = 0u;
            [[unroll]] for (uint k = 0u; k < SEARCH_AHEAD; ++k) {
                const vec3 position = sample_position(params, ray, begin, min(i + k, end_step - 1u));
                const Place place = place_at(params, position);
                if (!is_found) note(place, work);
                is_found = is_found || (place.distance == 0u && (place.is_missing ||
                                                                 may_be_seen(params, position, place)));
                const bool is_asked = !is_found && i + k < end_step && place.distance == 0u;
                if (COUNT_WORK != 0u) note_sample(is_asked, place, work);
                passed += is_found ? 0u : 1u;
            }
            i = min(i + passed, end_step);
            unseen += passed;
            searches = !is_found;
        }
        ++turn;
        if (COUNT_WORK != 0u) ++work.turns;
    } while (searches && i < end_step && turn < MAX_SEARCH_TURNS);
}

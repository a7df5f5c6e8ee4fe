// The search for the next sample that can be seen. In noise at the threshold hardly a cell is empty and hardly a sample
// shows anything, so samples are asked for their density alone, several at a time, before any is shaded. Needs
// raycast.comp's Ray, Place, Work and texels_at.
//
// Lanes that leave a loop early wait for the others, and lavapipe does not keep what a lane has set in a loop that it
// left: only the step and counts, which are added to, are carried out of these loops. What is found is read again.

// Lanes that have found nothing by then take a sample as the others do.
const uint MAX_SEARCH_TURNS = 20u;

// Whether the sample at `position` may show anything. Samples of paint may, whatever their density; and a step whose
// ends are classified is not judged by its middle.
bool may_be_seen(const RaycastParams params, vec3 position, const Place place)
{
    if (PREINTEGRATED != 0u) return true;
    const Texels texels = texels_at(position, place);
    const float density = value_of(density_at(texels.corner + texels.to_atlas, texels.fraction));
    return place.is_painted || (density >= params.table_lower && density <= params.table_upper);
}

// Goes on to a step whose sample may be seen, to the first that may not be followed further, or to `end_step`.
// `unseen` counts samples that showed nothing.
void search_sample(const RaycastParams params, const Ray ray, float begin, uint end_step, inout uint i,
                   inout uint unseen, inout Work work)
{
    uint turn = 0u;
    bool searches;
    do {
        bool leaps;
        do {
            const vec3 position = sample_position(params, ray, begin, i);
            const Place place = place_at(params, position);
            note(place, work);
            leaps = place.distance > 0u;
            if (leaps) {
                i += steps_to_leave(params, ray, position, place);
                unseen += SAMPLES_OF_LEAP;
                if (COUNT_WORK != 0u) ++work.leaps;
            }
        } while (leaps && i < end_step);
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
                if (COUNT_WORK != 0u && !is_found && i + k < end_step && place.distance == 0u) note_sample(place, work);
                passed += is_found ? 0u : 1u;
            }
            i = min(i + passed, end_step);
            unseen += passed;
            searches = !is_found;
        }
        ++turn;
    } while (searches && i < end_step && turn < MAX_SEARCH_TURNS);
}

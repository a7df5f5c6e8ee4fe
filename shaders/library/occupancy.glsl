// Whether the transfer function shows anything between two codes. Needs `params` and `visible_intervals`.
#include "to_int.glsl"

bool transfer_function_shows(uint range)
{
    const float lower = float(range & 0xffffu), upper = float(range >> 16);
    const float guard = params.guard;   // leap.h
    if (params.table_entries < 2u || upper + guard < params.table_lower || lower - guard > params.table_upper)
        return false;
    const float last = float(params.table_entries - 1u);
    const float from = (lower - guard - params.table_lower) * params.table_scale - 0.01;
    const float to = (upper + guard - params.table_lower) * params.table_scale + 0.01;
    const uint first_interval = to_uint(clamp(from, 0.0, last - 1.0));
    const uint last_interval = to_uint(clamp(to, 0.0, last - 1.0));
    return visible_intervals.before[last_interval + 1u] > visible_intervals.before[first_interval];
}

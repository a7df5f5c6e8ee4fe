// Does the transfer function show anything between two codes? Needs `params` and `visible_intervals`.

bool transfer_function_shows(uint range)
{
    const float lower = float(range & 0xffffu) / 65535.0;
    const float upper = float(range >> 16) / 65535.0;
    // The ray caster's own rounding may carry a sample a few ulp past the cell's range: the guard takes it in, so that
    // a picture with skipping equals one without, bit for bit.
    const float guard = 0.01;
    const float last = float(params.table_entries - 1u);
    const float from = lower * params.table_scale + params.table_bias - guard;
    const float to = upper * params.table_scale + params.table_bias + guard;
    if (to < 0.0 || from > last || params.table_entries < 2u) return false;
    const uint first_interval = uint(clamp(from, 0.0, last - 1.0));
    const uint last_interval = uint(clamp(to, 0.0, last - 1.0));
    return visible_intervals.before[last_interval + 1u] > visible_intervals.before[first_interval];
}

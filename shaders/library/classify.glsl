// Looks up a step, or part of a step, in the transfer function's table. Needs `table` and PREINTEGRATED. The layout of
// the table is in raycast.h.
#include "to_int.glsl"

ivec2 table_texel(uint index)
{
    return ivec2(index % TABLE_WIDTH, index / TABLE_WIDTH);
}

// 1 - exp(-depth). For small depths, cancellation would lose precision, so a series is used; it converges fast.
float opacity_of_depth(float depth)
{
    const float series =
        depth * (1.0 - depth / 2.0 * (1.0 - depth / 3.0 * (1.0 - depth / 4.0 * (1.0 - depth / 5.0))));
    return depth < 0.0625 ? series : 1.0 - exp2(-1.44269504 * min(depth, 100.0));
}

// Optical depth of a full step.
float table_depth(const RaycastParams params, uint entry)
{
    return imageLoad(table, table_texel(params.table_depths + entry / 4u))[entry % 4u];
}

// The place of a density in the table: between an entry and the next entry.
struct TablePlace {
    uint entry;
    float share;   // weight of the next one
    bool is_inside;
};

TablePlace table_place(const RaycastParams params, float density)
{
    const float last = float(params.table_entries - 1u);
    const float at = clamp((density - params.table_lower) * params.table_scale, 0.0, last);
    const uint entry = to_uint(min(at, last - 1.0));
    return TablePlace(entry, at - float(entry), density >= params.table_lower && density <= params.table_upper);
}

// Colour and opacity of a step for a density. Interpolates linearly between entries; opacity is 0 outside the table.
vec4 classify(const RaycastParams params, float density)
{
    const TablePlace place = table_place(params, density);
    vec4 look = mix(imageLoad(table, table_texel(place.entry)), imageLoad(table, table_texel(place.entry + 1u)),
                    place.share);
    look.a = place.is_inside ? look.a : 0.0;
    return look;
}

// The opacity of the fraction `part` (below 1) of a step.
float opacity_of_part(const RaycastParams params, float density, float part)
{
    const TablePlace place = table_place(params, density);
    const float opacity = mix(opacity_of_depth(part * table_depth(params, place.entry)),
                              opacity_of_depth(part * table_depth(params, place.entry + 1u)), place.share);
    return place.is_inside ? opacity : 0.0;
}

// Colour and opacity of the fraction `part` of a step along which the density changes from `front` to `back`. These two
// densities are the table's axes. The part of the step outside the function's range is empty.
vec4 classify_change(const RaycastParams params, float front, float back, float part)
{
    const vec2 ends = clamp(vec2(front, back), params.table_lower, params.table_upper);
    const float last = float(params.table_entries - 1u);
    const vec2 at = clamp((ends - params.table_lower) * params.table_scale, 0.0, last);
    const ivec2 entry = ivec2(min(at, last - 1.0));
    const vec2 share = at - vec2(entry);
    const vec4 near = mix(imageLoad(table, entry), imageLoad(table, entry + ivec2(1, 0)), share.x);
    const vec4 far = mix(imageLoad(table, entry + ivec2(0, 1)), imageLoad(table, entry + 1), share.x);
    const vec4 sum = mix(near, far, share.y);
    const float whole = abs(back - front), inside = abs(ends.y - ends.x);
    const bool is_inside = front >= params.table_lower && front <= params.table_upper;
    const float seen = part * (whole > 0.0 ? inside / whole : float(is_inside));
    const vec4 depths =
        seen * imageLoad(table, table_texel(params.table_depths + uint(entry.x) + TABLE_WIDTH * uint(entry.y)));
    const float of_part = mix(mix(opacity_of_depth(depths.x), opacity_of_depth(depths.y), share.x),
                              mix(opacity_of_depth(depths.z), opacity_of_depth(depths.w), share.x), share.y);
    const float opacity = seen >= 1.0 ? sum.a : seen > 0.0 ? of_part : 0.0;
    return vec4(sum.rgb / max(sum.a, 1e-30), opacity);
}

// An interval of opaque densities, at which rays end: its lower and upper end.
struct Opaque {
    vec4 lower, upper;   // colour, density
};

Opaque opaque_interval(const RaycastParams params, uint number)
{
    const uint at = params.opaque_map + OPAQUE_ENTRIES + 2u * number;
    return Opaque(imageLoad(table, table_texel(at)), imageLoad(table, table_texel(at + 1u)));
}

// The opaque interval that a density reaches first between `front` and `back`; an unreachable interval if none.
Opaque opaque_ahead(const RaycastParams params, float front, float back)
{
    const float at = clamp((front - params.table_lower) * params.opaque_scale, 0.0, float(OPAQUE_ENTRIES - 1u));
    const vec2 numbers = imageLoad(table, table_texel(params.opaque_map + to_uint(at))).xy;
    const bool rises = back >= front;
    const uint number = to_uint(rises ? numbers.x : numbers.y);
    const Opaque nearest = opaque_interval(params, number);
    const bool is_passed = rises ? nearest.upper.a < front : nearest.lower.a > front;
    if (!is_passed) return nearest;
    return opaque_interval(params, rises ? number + 1u : number - 1u);
}

// Like classify_change, but a step that reaches an opaque density shows the part before it, then the opaque colour.
vec4 classify_step(const RaycastParams params, float front, float back, float part)
{
    if (PREINTEGRATED < 2u) return classify_change(params, front, back, part);
    // The back of a step and the front of the next are the same point, but rounding may leave a gap of this size.
    const float gap = 0.004;   // codes
    const Opaque ahead = opaque_ahead(params, front, back);
    const float lower = min(front, back) - gap, upper = max(front, back) + gap;
    const bool is_met = ahead.upper.a >= lower && ahead.lower.a <= upper;
    const float there = clamp(front, ahead.lower.a, ahead.upper.a);
    const float whole = abs(back - front);
    const float before = whole > 0.0 ? min(abs(there - front) / whole, 1.0) : 0.0;
    const vec4 look = classify_change(params, front, is_met ? there : back, is_met ? part * before : part);
    const float width = ahead.upper.a - ahead.lower.a;
    const float along = width > 0.0 ? (there - ahead.lower.a) / width : 0.0;
    const vec3 color = mix(ahead.lower.rgb, ahead.upper.rgb, along);
    return is_met ? vec4(mix(color, look.rgb, look.a), 1.0) : look;
}

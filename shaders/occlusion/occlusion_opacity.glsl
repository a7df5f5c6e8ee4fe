// The opacity of a voxel to light (occlusion.h). Needs `opacities`, a buffer of OcclusionEntry; if MASKED, `mask` and
// its tables are bound from binding 6 on.
#include "../library/to_int.glsl"
#ifdef MASKED
layout(binding = 6, r8ui) uniform readonly uimage3D mask;
#define MASK_TABLE_BINDING 7
layout(binding = 8, scalar) readonly buffer GroupOpacities { float values[]; } group_opacities;

#ifdef PAGED
#define MASK_TABLE_HASHED
#endif
#include "../library/mask.glsl"
#endif

// Values at a code: its opacity, and the sums, each in two parts, of opacities and of their squares over the table's
// entries up to this code.
struct Sums {
    float opacity;
    vec2 sums, rests;
};

Sums sums_at(const OcclusionCellsParams params, float code)
{
    const float last = float(params.table_entries - 1u);
    const float at = clamp((code - params.table_lower) * params.table_scale, 0.0, last) + 0.5;
    const OcclusionEntry entry = opacities.entries[to_uint(at)];
    const vec2 each = vec2(entry.opacity, entry.opacity * entry.opacity);
    const bool is_inside = code >= params.table_lower && code <= params.table_upper;
    return Sums(is_inside ? entry.opacity : 0.0, entry.sums, entry.rests + fract(at) * each);
}

float opacity_of(const OcclusionCellsParams params, float code)
{
    return sums_at(params, code).opacity;
}

// The opacity that paint or the cut gives a voxel regardless of its density; below 0 if neither does. `centre` is in
// voxels of level 0.
float opacity_held(const OcclusionCellsParams params, vec3 centre)
{
    const bool inside = all(greaterThanEqual(centre, params.lower)) && all(lessThan(centre, params.upper)) &&
                        dot(params.cut_plane.xyz, centre) + params.cut_plane.w <= 0.0;
    float held = -1.0;
#ifdef MASKED
    // The position is clamped to the box; voxels outside the box are transparent in any case.
    const uvec3 painted = min(to_uint(max(centre, 0.0)), BRICK_SIZE * params.brick_counts - 1u);
    const uint slot = mask_slot_of(painted / BRICK_SIZE);
    if (slot != 0u) {
        const uint group = imageLoad(mask, ivec3(mask_slot_origin(slot) + painted % BRICK_SIZE)).x;
        held = group != 0u ? group_opacities.values[group] : -1.0;
    }
#endif
    return inside ? held : 0.0;
}

// Computes one step of a ray: density, transfer function, paint, light. Needs raycast.comp's Ray and Place,
// density_*.glsl and shade.glsl; if MASKED, also mask.glsl and `groups`; if OCCLUDED, also occlusion.glsl.
#include "classify.glsl"
#include "texels.glsl"
#ifdef MASKED
#include "groups.glsl"
#endif

#ifdef MASKED
uint group_at(const RaycastParams params, vec3 position)
{
    return SMOOTH_BORDERS != 0u ? group_around(position, ivec3(params.position_limit)) : group_of(to_uint(position));
}

// A painted voxel has its group's look, regardless of its density.
vec4 painted(uint group, vec4 look)
{
    if (group == 0u) return look;
    return imageLoad(groups, ivec2(group, 0));
}
#endif

// The density at a point in the brick whose first voxel is at `first`, or up to half a voxel outside that brick.
float value_near(vec3 in_brick, ivec3 first)
{
    const vec3 held = clamp(in_brick, -1.0, float(BRICK_SIZE));   // including its aprons
    const vec3 corner = min(floor(held), float(BRICK_SIZE) - 1.0);
    return value_of(density_at(int_of_whole(corner) + first, held - corner));
}

// The density at an end of a step, at length `s` along the ray. `texels` are those of the step's middle; the apron of
// their brick includes both ends. The end of a step and the beginning of the next step get the same bits if both are in
// bricks of one level, because only whole numbers are subtracted from a position.
float value_at_end(const RaycastParams params, const Ray ray, float s, const Texels texels, const Place place)
{
    vec3 lattice = position_at(params, ray, s);
#ifdef PAGED
    lattice *= uintBitsToFloat(127u - place.level << 23);
#endif
    const uvec3 brick = texels.brick * BRICK_SIZE;
    return value_near(lattice - 0.5 - vec3(brick), texels.to_atlas + ivec3(brick));
}

struct Sample {
    vec4 look;       // colour, shaded, and opacity
    float density;   // PREINTEGRATED: not used
    uint group;      // 0: none
};

// Samples a step with its middle at `position`, in the brick at `place`. PREINTEGRATED: `ends` are the densities at the
// step's beginning and end, and the result has the opacity of the fraction `part` of a step. Otherwise it has the
// opacity of a whole step (see opacity_of_rest).
Sample sample_at(const RaycastParams params, const Ray ray, vec3 position, float part, const Place place, vec2 ends)
{
    const Texels texels = texels_at(position, place);
    Density density;
    if (PREINTEGRATED == 0u || SHADED != 0u) density = density_at(texels.corner + texels.to_atlas, texels.fraction);
    Sample found = Sample(vec4(0.0), PREINTEGRATED != 0u ? 0.0 : value_of(density), 0u);
    found.look = PREINTEGRATED != 0u ? classify_step(params, ends.x, ends.y, part) : classify(params, found.density);
#ifdef MASKED
    if (place.is_painted) {
        found.group = group_at(params, position);
        found.look = painted(found.group, found.look);
    }
#endif
#ifndef PICKS
    if (SHADED != 0u) {
        float ambient = params.ambient;
#ifdef OCCLUDED
#ifdef PAGED
        const uvec3 last = to_uint(params.position_limit) >> place.level;
#else
        const uvec3 last = to_uint(params.position_limit);
#endif
        const ivec3 to_values =
            ivec3(slot_origin(texels.slot)) - ivec3(texels.brick * BRICK_SIZE) + int(BRICK_APRON);
        ambient *= ambient_share(texels.lattice, to_values, vec3(last));
#endif
        const vec3 slope = ANALYTIC_GRADIENT != 0u ? analytic_gradient_of(density) : gradient_of(density);
        found.look.rgb = shade(params, ambient, found.look.rgb, slope * params.inverse_spacing, ray.half_way);
    }
    if (DISTANCE_BLEND != 0u) found.look.rgb = blended(params, found.look.rgb, position);
#endif
    return found;
}

// The opacity of the fraction `part` of a step, given the sample at its middle.
float opacity_of_rest(const RaycastParams params, const Sample taken, float part)
{
    if (part >= 1.0) return taken.look.a;
#ifdef MASKED
    if (taken.group != 0u) return opacity_of_depth(part * imageLoad(groups, ivec2(taken.group, 1)).x);
#endif
    return PREINTEGRATED != 0u ? taken.look.a : opacity_of_part(params, taken.density, part);
}

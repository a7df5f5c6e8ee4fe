// Computes what a ray sees in one step: density, transfer function, paint, light. Needs raycast.comp's Ray and Place,
// density_*.glsl, shade.glsl, if MASKED mask.glsl and `groups`, if OCCLUDED occlusion.glsl.
#include "classify.glsl"
#ifdef MASKED
#include "groups.glsl"
#endif

// Rounding may move a ray that runs along a face an ulp outside. Below 0 that still truncates to voxel 0; above, it is
// clamped.
vec3 position_at(const RaycastParams params, const Ray ray, float s)
{
    return min(ray.origin + s * ray.direction, params.position_limit);
}

// Grey, perceptually uniform: the inverse of the curve with which pictures are encoded (IEC 61966-2-1).
vec4 slice_look(const RaycastParams params, float density)
{
    const float grey = clamp((density - params.slice_black) * params.slice_scale, 0.0, 1.0);
    const float light = grey <= 0.04045 ? grey / 12.92 : exp2(2.4 * log2((grey + 0.055) / 1.055));
    return vec4(vec3(light), 1.0);
}

#ifdef MASKED
uint group_at(const RaycastParams params, vec3 position)
{
    return SMOOTH_BORDERS != 0u ? group_around(position, ivec3(params.position_limit)) : group_of(uvec3(position));
}

// A painted voxel has the look of its group, whatever its density.
vec4 painted(const RaycastParams params, uint group, vec4 look)
{
    if (group == 0u) return look;
    const vec4 of_group = imageLoad(groups, ivec2(group, 0));
    if (SLICE == 0u) return of_group;
    return vec4(mix(look.rgb, of_group.rgb, of_group.a > 0.0 ? params.slice_paint : 0.0), 1.0);
}
#endif

// The texels around a position.
struct Texels {
    vec3 lattice;    // of voxel centres of the brick's level
    uvec3 brick;
    ivec3 corner;
    vec3 fraction;   // between the corner and the next texels
    ivec3 to_atlas;
    uint slot;
};

// Cell and fraction come from the global position, and only the integer part is moved into the brick: a bricked volume
// gives the same bits as one in a single texture. If there is no brick, the values read are not used.
Texels texels_at(vec3 position, const Place place)
{
    Texels texels;
#ifdef PAGED
    texels.lattice = position * uintBitsToFloat(127u - place.level << 23) - 0.5;   // times 2^-level, exactly
    texels.brick = uvec3(position) >> place.level + 5u;
    texels.slot = place.distance > 0u || place.is_missing ? NO_SLOT : place.slot;
#else
    texels.lattice = position - 0.5;
    texels.brick = uvec3(position) / BRICK_SIZE;
    texels.slot = place.slot;
#endif
    const vec3 corner = floor(texels.lattice);
    texels.corner = ivec3(corner);
    texels.fraction = texels.lattice - corner;
#ifdef PAGED
    texels.to_atlas = place_in_slot(texels.slot) - ivec3(texels.brick * BRICK_SIZE);
#else
    texels.to_atlas = place_of_first();
#endif
    return texels;
}

// The density at a point at most half a voxel outside the brick whose first voxel is at `first`.
float value_near(vec3 in_brick, ivec3 first)
{
    const vec3 held = clamp(in_brick, -1.0, float(BRICK_SIZE));   // including its aprons
    const vec3 corner = min(floor(held), float(BRICK_SIZE) - 1.0);
    return value_of(density_at(ivec3(corner) + first, held - corner));
}

// The density where a step begins or ends, at length `s` along the ray; `texels` are of the step's middle, whose brick
// reaches that far. One step's end is the next one's beginning, with the same bits if both are in bricks of one level,
// because only whole numbers are subtracted from a position.
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

// A step with its middle at `position`, in the brick at `place`. PREINTEGRATED: `ends` are the densities at its
// beginning and end, and its opacity is that of the fraction `part` of a step; otherwise that of a whole one
// (opacity_of_rest).
Sample sample_at(const RaycastParams params, const Ray ray, vec3 position, float part, const Place place, vec2 ends)
{
    const Texels texels = texels_at(position, place);
    Density density;
    if (PREINTEGRATED == 0u || SHADED != 0u) density = density_at(texels.corner + texels.to_atlas, texels.fraction);
    Sample found = Sample(vec4(0.0), PREINTEGRATED != 0u ? 0.0 : value_of(density), 0u);
    if (PREINTEGRATED != 0u) {
        found.look = classify_step(params, ends.x, ends.y, part);
    } else {
        found.look = SLICE != 0u ? slice_look(params, found.density) : classify(params, found.density);
    }
#ifdef MASKED
    if (place.is_painted) {
        found.group = group_at(params, position);
        found.look = painted(params, found.group, found.look);
    }
#endif
    if (SHADED != 0u) {
        float ambient = params.ambient;
#ifdef OCCLUDED
#ifdef PAGED
        const uvec3 last = uvec3(params.position_limit) >> place.level;
#else
        const uvec3 last = uvec3(params.position_limit);
#endif
        const ivec3 to_values =
            ivec3(slot_origin(texels.slot)) - ivec3(texels.brick * BRICK_SIZE) + int(BRICK_APRON);
        ambient *= ambient_share(texels.lattice, to_values, vec3(last));
#endif
        found.look.rgb =
            shade(params, ambient, found.look.rgb, gradient_of(density) * params.inverse_spacing, ray.half_way);
    }
    if (DISTANCE_BLEND != 0u) found.look.rgb = blended(params, found.look.rgb, position);
    return found;
}

// The opacity of the fraction `part` of a step whose middle was sampled.
float opacity_of_rest(const RaycastParams params, const Sample taken, float part)
{
    if (part >= 1.0) return taken.look.a;
#ifdef MASKED
    if (taken.group != 0u) return opacity_of_depth(part * imageLoad(groups, ivec2(taken.group, 1)).x);
#endif
    return PREINTEGRATED != 0u ? taken.look.a : opacity_of_part(params, taken.density, part);
}

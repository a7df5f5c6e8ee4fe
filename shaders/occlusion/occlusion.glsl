// The light that reaches a sample, interpolated between voxel values (occlusion.h). Needs `occlusion` (r8ui) and
// `occlusion_look`. Interpolates by arithmetic: 8-bit filters are coarse on many devices, and not every device can
// filter this format.
#include "../library/to_int.glsl"

float occlusion_value(ivec3 texel)
{
    return float(imageLoad(occlusion, texel).x);
}

// `lattice`: position in voxels of the brick's level. `to_values`: offset from this position to the brick's texels.
// `last`: the last voxel of this level.
float ambient_share(vec3 lattice, ivec3 to_values, vec3 last)
{
    const vec3 held = clamp(lattice, vec3(0.0), last);   // no values exist beyond the volume's edge
    const vec3 corner = floor(held), f = held - corner;
    const ivec3 c = int_of_whole(corner) + to_values;
    vec4 v = mix(vec4(occlusion_value(c), occlusion_value(c + ivec3(0, 1, 0)), occlusion_value(c + ivec3(0, 0, 1)),
                      occlusion_value(c + ivec3(0, 1, 1))),
                 vec4(occlusion_value(c + ivec3(1, 0, 0)), occlusion_value(c + ivec3(1, 1, 0)),
                      occlusion_value(c + ivec3(1, 0, 1)), occlusion_value(c + ivec3(1, 1, 1))), f.x);
    const vec2 w = mix(v.xz, v.yw, f.y);
    const float value = clamp(mix(w.x, w.y, f.z) / 255.0, 1e-4, 1.0);
    float curved = value;
    if (OCCLUSION_MAPPED != 0u) {
        curved = occlusion_look.data.lowest;
        for (uint i = 0u; i < occlusion_look.data.segments; ++i) {
            const OcclusionSegment s = occlusion_look.segments[i];
            curved += s.rise * clamp((value - s.begin) * s.per_width, 0.0, 1.0);
        }
    } else if (occlusion_look.data.curve != 1.0) {
        curved = exp2(occlusion_look.data.curve * log2(value));
    }
    return 1.0 - occlusion_look.data.strength * (1.0 - curved);
}

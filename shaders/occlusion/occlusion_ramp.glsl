// Makes ramps (occlusion.h). Needs occlusion_opacity.glsl.
#include "../library/to_int.glsl"

// Constants found by optimization, as in occlusion_bake.comp. A ramp has its full slope if the variance of the opacity,
// for a top of 1, is above 1 / RAMP_UNEVEN.
const float RAMP_UNEVEN = 230.0;
// Maximum steepness of a ramp across the cube.
const float STEEPEST_OF_VOXELS = 3.3, STEEPEST_OF_CELLS = 2.6;

// `level`, `squares`: the means, over the cube, of the opacity and of its square, for a `top` of 1. `direction`: the
// direction in which the opacity rises. If the ramp ends inside the cube, its width follows from these two means; if
// the opacity hardly varies, there is no ramp.
uint packed_ramp(float top, float level, float squares, vec3 direction, float steepest)
{
    const float steepness = 1.0 / max(6.0 * (level - squares), 1.0 / steepest);
    const float share = min(RAMP_UNEVEN * max(squares - level * level, 0.0), 1.0);
    const int height = int(round(clamp(RAMP_HEIGHTS * (level - 0.5) * steepness, -30.0, 30.0)));
    const ivec3 slope = ivec3(round(clamp(RAMP_SLOPES * share * steepness * direction, -31.0, 31.0)));
    const uint code = to_uint(255.0 * sqrt(clamp(top, 0.0, 1.0)) + 0.5);
    return code == 0u ? 0u : ramp_bits(code, height, slope);
}

// The ramp of a cube, given the density at its centre, the slope across it, and its lowest and highest density.
uint ramp_of(const OcclusionCellsParams params, float middle, vec3 slope, float least, float most, float steepest)
{
    // Assumes that densities are uniformly spread along the slope, within the cube's range; exact along an axis.
    const float steep = length(slope), half_width = max(0.5 * steep, 0.5 / params.table_scale);
    const float lower = middle - half_width, upper = middle + half_width;
    const float from = clamp(lower, least, most), to = clamp(upper, least, most);
    const Sums at_from = sums_at(params, from), at_to = sums_at(params, to);
    const float a = at_from.opacity, b = at_to.opacity;
    const vec2 held = (from - lower) * vec2(a, a * a) + (upper - to) * vec2(b, b * b);
    const vec2 between = (at_to.sums - at_from.sums) + (at_to.rests - at_from.rests);
    const vec2 mean = max(between / params.table_scale + held, 0.0) / (2.0 * half_width);
    const float top = max(max(a, b), mean.y / max(mean.x, 1e-10));
    const float inverse = 1.0 / max(top, 1e-10);
    const float up = (b < a ? -1.0 : 1.0) / max(steep, 1e-6);
    return packed_ramp(top, min(mean.x * inverse, 1.0), min(mean.y * inverse * inverse, 1.0), up * slope, steepest);
}

// The ramp of a voxel with a fixed opacity.
uint held_ramp(float opacity)
{
    return ramp_bits(to_uint(255.0 * sqrt(clamp(opacity, 0.0, 1.0)) + 0.5), RAMP_HELD, ivec3(0));
}

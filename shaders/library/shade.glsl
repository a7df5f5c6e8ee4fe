// Local illumination.
#include "blend.glsl"

// x^shininess. Powers of two, used by most sessions, are computed by squaring: exp2 and log2 took a tenth of a shaded
// picture's time on a CPU. The lower bound avoids denormal intermediate values, which are even slower.
float power(float x, float shininess)
{
    if (SHININESS_SQUARINGS < NOT_A_POWER_OF_TWO) {
        x = max(x, exp2(-120.0 / float(1u << SHININESS_SQUARINGS)));
        for (uint i = 0u; i < SHININESS_SQUARINGS; ++i) x *= x;
        return x;
    }
    // pow() leaves x^0 and 0^y undefined.
    return shininess == 0.0 ? 1.0 : x <= 0.0 ? 0.0 : exp2(shininess * log2(x));
}

// The normalised half vector; 0 if the light is exactly opposite to the eye.
vec3 half_way(vec3 light, vec3 to_eye)
{
    const vec3 sum = light + to_eye;
    const float sum_length = length(sum);
    return sum_length > 1e-6 ? sum / sum_length : vec3(0.0);
}

// Blinn-Phong with one white light (Blinn 1977). `surface`: how much the normal is that of a surface, 0 to 1; at 0
// there is no highlight, and the diffuse term has its full value in all directions.
vec3 lit(const RaycastParams params, float ambient, vec3 color, vec3 normal, float surface, vec3 half_way)
{
    const float facing = max(dot(normal, params.light), 0.0);
    const float mirrored = max(dot(normal, half_way), 0.0);
    const float highlight = facing > 0.0 ? surface * params.specular * power(mirrored, params.shininess) : 0.0;
    return min(color * (ambient + params.diffuse * mix(1.0, facing, surface)) + highlight, vec3(1.0));
}

// A gradient far below `gradient_fade` counts as no surface; otherwise flat regions would flicker or turn dark.
vec3 shade(const RaycastParams params, float ambient, vec3 color, vec3 slope, vec3 half_way)
{
    const float square = dot(slope, slope);
    const float fade = params.gradient_fade * params.gradient_fade;
    const float surface = square > 0.0 ? square / (square + fade) : 0.0;
    const vec3 normal = square > 0.0 ? -slope * inversesqrt(square) : vec3(0.0);
    return lit(params, ambient, color, normal, surface, half_way);
}

// Local illumination, and the opacity of a part of a step.

// x^0 = 1, 0^y = 0 for y > 0; pow() itself leaves both undefined.
float power(float x, float y)
{
    return y == 0.0 ? 1.0 : x <= 0.0 ? 0.0 : exp2(y * log2(x));
}

// Blinn-Phong with one white light. Where the gradient is far below `gradient_fade` there is no surface: the highlight
// goes and the diffuse term becomes its full, directionless value, so that flat regions neither sparkle nor go dark.
// The half vector is normalised (Blinn 1977), and has no length where the light is behind the sample.
vec3 shade(const RaycastParams params, vec3 color, vec3 slope, vec3 to_eye)
{
    const float square = dot(slope, slope);
    const float fade = params.gradient_fade * params.gradient_fade;
    const float surface = square > 0.0 ? square / (square + fade) : 0.0;
    const vec3 normal = square > 0.0 ? -slope * inversesqrt(square) : vec3(0.0);
    const float facing = max(dot(normal, params.light), 0.0);
    const vec3 half_way = params.light + to_eye;
    const float half_length = length(half_way);
    const float mirrored = half_length > 1e-6 ? max(dot(normal, half_way) / half_length, 0.0) : 0.0;
    const float highlight = facing > 0.0 ? surface * params.specular * power(mirrored, params.shininess) : 0.0;
    return min(color * (params.ambient + params.diffuse * mix(1.0, facing, surface)) + highlight, vec3(1.0));
}

// 1 - (1 - a)^part for 0 < part <= 1. The plain form loses small opacities to cancellation; the binomial series has none
// and converges fast for small `a`.
float opacity_of_part(float a, float part)
{
    const float series = part * a * (1.0 + 0.5 * (1.0 - part) * a * (1.0 + (2.0 - part) / 3.0 * a *
                         (1.0 + (3.0 - part) / 4.0 * a * (1.0 + (4.0 - part) / 5.0 * a))));
    return a < 0.0625 ? series : a >= 1.0 ? 1.0 : 1.0 - exp2(part * log2(1.0 - a));
}

// Colour blending by distance, and the background of a picture.

// Distance colour blending (Rheingans and Ebert 2001, Volume illustration): mixes in a colour with growing distance.
vec3 blended(const RaycastParams params, vec3 color, vec3 position)
{
    const float depth = clamp(dot(params.depth_plane.xyz, position) + params.depth_plane.w, 0.0, 1.0);
    // pow() leaves 0^0 undefined; it is 1.
    const float grown = params.blend_rate == 0.0 ? 1.0 : depth <= 0.0 ? 0.0 : exp2(params.blend_rate * log2(depth));
    return mix(color, params.blend_color, min(params.blend_size * grown, 1.0));
}

// Composites a ray's premultiplied sum over the background.
vec4 over_background(const RaycastParams params, vec4 sum)
{
    const float through = (1.0 - sum.a) * params.background.a;
    return vec4(sum.rgb + through * params.background.rgb, sum.a + through);
}

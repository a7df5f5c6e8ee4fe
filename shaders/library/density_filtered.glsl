// Sampling of the density by the device's own trilinear filter, with the interface of density_exact.glsl. Needs
// `atlas`, a sampler3D of R16_UNORM codes, and `density_reads`, which counts. Real filters round their weights,
// commonly to 8 bits, so results differ from exact sampling by up to 1/512 of the local difference per axis.

struct Density {
    vec3 at;   // texture coordinates
};

Density density_at(ivec3 corner, vec3 fraction)
{
    return Density((vec3(corner) + fraction + 0.5) / vec3(textureSize(atlas, 0)));
}

float tap(vec3 at)
{
    if (COUNT_WORK != 0u) ++density_reads;
    return textureLod(atlas, at, 0.0).x;
}

float value_of(const Density d)
{
    return 65535.0 * tap(d.at);
}

vec3 gradient_of(const Density d)
{
    const vec3 h = 0.5 / vec3(textureSize(atlas, 0));
    const vec3 x = vec3(h.x, 0.0, 0.0), y = vec3(0.0, h.y, 0.0), z = vec3(0.0, 0.0, h.z);
    return 65535.0 *
           vec3(tap(d.at + x) - tap(d.at - x), tap(d.at + y) - tap(d.at - y), tap(d.at + z) - tap(d.at - z));
}

// Samples the density by the device's own trilinear filter, with the interface of density_exact.glsl. Needs `atlas`, a
// sampler3D of R16_UNORM codes, and the counter `density_reads`. Devices round filter weights, commonly to 8 bits, so
// results differ from exact sampling by up to 1/512 of the local difference per axis.
#include "atlas.glsl"

struct Density {
    vec3 at;     // texture coordinates
    int which;   // index of the image, if the atlas has several
};

Density density_at(ivec3 corner, vec3 fraction)
{
    int which = 0;
#ifdef STACKED
    if (ATLASES > 1u) {
        const int height = textureSize(atlas, 0).z;
        which = atlas_of(corner.z, height);
        corner.z -= which * height;
    }
#endif
    return Density((vec3(corner) + fraction + 0.5) / vec3(textureSize(atlas, 0)), which);
}

float tap(vec3 at, int which)
{
    if (COUNT_WORK != 0u) ++density_reads;
#ifdef STACKED
    if (ATLASES > 1u) {
        if (which == 1) return textureLod(atlas_1, at, 0.0).x;
        if (which == 2) return textureLod(atlas_2, at, 0.0).x;
        if (which == 3) return textureLod(atlas_3, at, 0.0).x;
    }
#endif
    return textureLod(atlas, at, 0.0).x;
}

float value_of(const Density d)
{
    return 65535.0 * tap(d.at, d.which);
}

vec3 gradient_of(const Density d)
{
    const vec3 h = 0.5 / vec3(textureSize(atlas, 0));
    const vec3 x = vec3(h.x, 0.0, 0.0), y = vec3(0.0, h.y, 0.0), z = vec3(0.0, 0.0, h.z);
    return 65535.0 * vec3(tap(d.at + x, d.which) - tap(d.at - x, d.which),
                          tap(d.at + y, d.which) - tap(d.at - y, d.which),
                          tap(d.at + z, d.which) - tap(d.at - z, d.which));
}

/// The derivative of the interpolation: differences between opposite faces of the cell. As many taps as gradient_of().
vec3 analytic_gradient_of(const Density d)
{
    const vec3 size = vec3(textureSize(atlas, 0));
    const vec3 low = (floor(d.at * size - 0.5) + 0.5) / size, high = low + 1.0 / size;
    const vec3 at = d.at;
    const int i = d.which;
    return 65535.0 * vec3(tap(vec3(high.x, at.yz), i) - tap(vec3(low.x, at.yz), i),
                          tap(vec3(at.x, high.y, at.z), i) - tap(vec3(at.x, low.y, at.z), i),
                          tap(vec3(at.xy, high.z), i) - tap(vec3(at.xy, low.z), i));
}

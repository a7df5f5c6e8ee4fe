// The 16-bit code of one texel of the density atlas, in either of its formats. Needs `atlas`, and FILTERED if it is for
// a sampler.
#include "atlas.glsl"

float code_at(ivec3 texel)
{
#ifdef FILTERED
    return round(65535.0 * atlas_texel(texel));
#else
    const uint pair = atlas_pair(ivec3(texel.x >> 1, texel.yz));
    return float((texel.x & 1) != 0 ? pair >> 16 : pair & 0xffffu);
#endif
}

// The 16-bit code of one texel of the density atlas, in either of its formats. Needs `atlas`, and FILTERED if it is for
// a sampler.

float code_at(ivec3 texel)
{
#ifdef FILTERED
    return round(65535.0 * texelFetch(atlas, texel, 0).x);
#else
    const uint pair = imageLoad(atlas, ivec3(texel.x >> 1, texel.yz)).x;
    return float((texel.x & 1) != 0 ? pair >> 16 : pair & 0xffffu);
#endif
}

// Reads the 16-bit code of one voxel of the density atlas, in any layout. Needs what atlas.glsl needs. If bricks are
// contiguous, the outermost voxels along x are repeated.
#include "atlas.glsl"

float code_at(ivec3 place)
{
    const int x = clamp(place.x, 0, last_along_x());
#ifdef FILTERED
    return round(65535.0 * atlas_texel(ivec3(x, place.yz)));
#else
    const uint word = atlas_word(ivec3(x >> WORD_SHIFT, place.yz));
    return float(CODE_UNIT * (word >> shift_to(x) & CODE_MASK));
#endif
}

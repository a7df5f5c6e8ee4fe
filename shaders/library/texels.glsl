// Locates the texels around a position. Needs density_*.glsl and Place.
#include "to_int.glsl"

struct Texels {
    vec3 lattice;    // position in units of the brick's voxels, 0 at the first voxel's centre
    uvec3 brick;
    ivec3 corner;
    vec3 fraction;   // between the corner and the next texels
    ivec3 to_atlas;
    uint slot;
};

// Cell and fraction are computed from the global position; only the integer part is moved into the brick. So a bricked
// volume gives the same bits as a volume in a single texture. Without a brick, the values read are unused.
Texels texels_at(vec3 position, const Place place)
{
    Texels texels;
#ifdef PAGED
    texels.lattice = position * uintBitsToFloat(127u - place.level << 23) - 0.5;   // times 2^-level, exactly
    texels.brick = to_uint(position) >> place.level + 5u;
    texels.slot = place.distance > 0u || place.is_missing ? NO_SLOT : place.slot;
#else
    texels.lattice = position - 0.5;
    texels.brick = to_uint(position) / BRICK_SIZE;
    texels.slot = place.slot;
#endif
    const vec3 corner = floor(texels.lattice);
    texels.corner = int_of_whole(corner);
    texels.fraction = texels.lattice - corner;
#ifdef PAGED
    texels.to_atlas = place_in_slot(texels.slot) - ivec3(texels.brick * BRICK_SIZE);
#else
    texels.to_atlas = place_of_first();
#endif
    return texels;
}

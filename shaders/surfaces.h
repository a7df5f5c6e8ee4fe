// Opaque surfaces that end rays: balls, rods, and triangles of meshes; intersections are exact. Lengths and positions
// are in isotropic space: physical positions divided by the reference length, the shortest side of a voxel.
#ifndef SHVR_SURFACES_H
#define SHVR_SURFACES_H
#include "shared.h"

SHARED_BEGIN

/// The convex hull of two balls (a round cone), or one ball if `along` is 0. The first ball is at `from` + `from_rest`,
/// where `from_rest` has the digits that a float loses in a large volume. Stored as four texels of four words.
struct Surface {
    vec3 from;
    float radius_from;
    vec3 along;       ///< from the first ball to the second
    float radius_to;  ///< radius of the second ball; neither ball contains the other
    vec3 from_rest;
    uint number;  ///< tie-breaker: of two surfaces at equal length, the lower number is visible
    vec3 color;   ///< linear light
    uint unused;
};

/// A triangle of a mesh, seen from both sides. Corners are stored whole: triangles that share one have the same bits
/// there, so that no ray passes between them. A list holds surfaces or triangles, never both. Stored as four texels.
struct Triangle {
    vec3 a;
    uint number;  ///< tie-breaker, as above
    vec3 b;
    uint normal_a;  ///< at corner `a`, octahedral (triangle.glsl); the others likewise
    vec3 c;
    uint normal_b;
    vec3 color;  ///< linear light
    uint normal_c;
};

/// A box around surfaces. Nodes are in depth-first order: a node is followed by its first child or, if it has no child,
/// by node `skip`. Stored as three texels of four words.
struct SurfaceNode {
    vec3 lower;
    uint skip;  ///< index of the next node that is outside this node's subtree
    vec3 upper;
    uint begin;  ///< range of a leaf's surfaces; begin == end in other nodes
    uint end;
    uvec3 unused;
};

/// Maximum surfaces in a leaf. Smaller leaves mean more boxes to load, larger leaves more rods to intersect.
SHARED_CONST uint SURFACES_IN_LEAF = 4u;

/// Surfaces and nodes are stored in images, in rows of this length: devices without a cache for buffers read buffers
/// one thread at a time.
SHARED_CONST uint SURFACES_IN_ROW = 1024u;
SHARED_CONST uint SURFACE_TEXELS = 4u;
SHARED_CONST uint SURFACE_NODE_TEXELS = 3u;

/// The ray of a pixel passes through a point of the middle plane, in the direction from a point of the near plane to a
/// point of the far plane. Points are relative to the centre of the middle plane, at which the user looks, so points
/// near it stay accurate even if the volume is large and the eye is far.
struct SurfaceParams {
    vec3 origin;  ///< all other positions are relative to origin + origin_rest
    vec3 origin_rest;
    vec3 middle_corner;
    vec3 middle_dx;
    vec3 middle_dy;
    vec3 along_corner;  ///< vector from the near plane to the far plane
    vec3 along_dx;
    vec3 along_dy;
    float begin;   ///< start of the clip range: 0 is the near plane, 1 the far plane
    float middle;  ///< position of the middle plane
    float end;     ///< end of the clip range
    float slack;   ///< margin added to boxes on each side, above the rounding error
    uint node_count;
    uint first_node;  ///< range of nodes that this dispatch visits for tiles; rays visit up to nodes_in_round of all
    uint end_node;
    uint nodes_in_round;
    uint is_first_round;
    uint is_last_round;
    vec3 probe_center;  ///< position relative to the origin; the probe is an additional ball
    float probe_radius;
    vec3 probe_color;  ///< linear light
};

/// Side of a tile in pixels; tiles start at the part's first pixel. A tile has a texel per pixel. The first texel
/// counts surfaces that the tile's rays may meet; every other texel has a surface's index and, from bit SURFACE_BLOCK
/// on, a bit for each of the tile's blocks of 4 x 2 pixels. If not all surfaces fit, rays search the boxes instead.
SHARED_CONST uint SURFACE_TILE = 8u;
SHARED_CONST uint SURFACES_IN_TILE = SURFACE_TILE * SURFACE_TILE - 1u;
SHARED_CONST uint SURFACE_BLOCK = 24u;  // no scene has 2^24 surfaces

SHARED_FUNCTION uvec2 surface_tiles_of(uvec2 pixels)
{
    return (pixels + SURFACE_TILE - 1u) / SURFACE_TILE;
}

/// Returns the bit of the block of 4 x 2 pixels that contains a pixel: bits 0 and 1 stand for the blocks in the tile's
/// first two rows, bits 2 and 3 for the blocks in the next two, and so on.
SHARED_FUNCTION uint surface_block(uvec2 in_part)
{
    return SURFACE_BLOCK + in_part.x / 4u % 2u + 2u * (in_part.y / 2u % 4u);
}

/// Returns the texel of a word in a tile's list; word 0 is the number of listed surfaces.
SHARED_FUNCTION uvec2 surface_tile_texel(uvec2 tile, uint word)
{
    return SURFACE_TILE * tile + uvec2(word % SURFACE_TILE, word / SURFACE_TILE);
}

/// Length along a ray that meets no surface.
SHARED_CONST float NO_SURFACE = 1e30f;

SHARED_END
#endif

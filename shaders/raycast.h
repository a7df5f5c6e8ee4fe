// Parameters of the ray caster. Lengths along a ray are in reference lengths: one voxel along the finest axis.
#ifndef SHVR_RAYCAST_H
#define SHVR_RAYCAST_H
#include "leap.h"

SHARED_BEGIN

/// The transfer function's table is an image in rows of TABLE_WIDTH texels: first its entries (preintegrated:
/// TABLE_WIDTH x TABLE_WIDTH, front density along x), padded to whole rows. From texel `table_depths` on, it has the
/// optical depths of a full step, OPAQUE_DEPTH if the step is opaque: opacity alone would round to 1, and the opacity
/// of a part of such a step would be unknown. A texel has the depths of four successive entries. Preintegrated: one
/// texel per entry, with the depths of the entry and of its neighbours along x, y and both.
SHARED_CONST uint TABLE_WIDTH = 256u;
SHARED_CONST float OPAQUE_DEPTH = 1e30f;

/// From texel `opaque_map` on, the table shows where a preintegrated function reaches opacity 1: OPAQUE_ENTRIES texels
/// over its range, in which x is the first opaque interval that ends at or above the texel, and y the last interval
/// that begins at or below the next texel. The intervals follow: two texels each, with colour and density at the
/// beginning and at the end. The first and the last interval are unreachable sentinels.
SHARED_CONST uint OPAQUE_ENTRIES = 65536u;
SHARED_CONST float OUT_OF_REACH = 1e30f;

/// From texel `points` on, the table has the function's `point_count` points for integral.comp, sorted by density:
/// first a texel each with colour and opacity of a reference length, then a texel each with the density in codes.

/// The constant SHININESS_SQUARINGS of kernels is log2 of the shininess, or this value if that is not a small integer.
SHARED_CONST uint NOT_A_POWER_OF_TWO = 10u;

/// Values of the specialization constant SHELL: no iso-surface, or the shape of the region that shows it.
SHARED_CONST uint SHELL_NONE = 0u;
SHARED_CONST uint SHELL_BALL = 1u;
SHARED_CONST uint SHELL_BOX = 2u;

/// The specialization constant PICK: the target's first row receives the answer; between blocks, the other rows hold
/// the state of the runs. A rise below MIN_SEEN does not count as visible.
SHARED_CONST uint PICK_ROWS = 3u;
SHARED_CONST float MIN_SEEN = 0.015625f;

/// The specialization constant KEPT: the values that a ray stores in the image `rays` between two dispatches, in
/// addition to the colour accumulated in its pixel. x: length of the ray up to the next iso-surface; y: length from
/// which the search continues (negative before the region). KEPT_ALL, for rays that each wait for bricks at their own
/// position, adds z, w: the next step, in two halves of 16 bits, with RAY_* times 65536 added to w. The image then has
/// a second half, below the first, for the accumulated colour, and every dispatch writes fully composited pixels.
SHARED_CONST uint KEPT_NOTHING = 0u;
SHARED_CONST uint KEPT_SHELL = 1u;
SHARED_CONST uint KEPT_ALL = 2u;
SHARED_CONST uint RAY_IS_INSIDE = 1u;  // the iso-surface
SHARED_CONST uint RAY_IS_DONE = 2u;

/// Number of samples per iteration whose density is read to find a visible sample (library/search.glsl).
SHARED_CONST uint SEARCH_AHEAD = 4u;

struct RaycastParams {
    // The ray of a pixel joins two points on planes near the volume, in voxel space; computed in double on the CPU.
    vec3 near_corner;
    vec3 near_dx;
    vec3 near_dy;
    vec3 far_corner;
    vec3 far_dx;
    vec3 far_dy;
    uvec2 pixel_begin;  ///< the part of the picture to draw
    uvec2 pixel_end;
    uvec2 target;       ///< texel of pixel_begin
    uvec2 drawn_begin;  ///< pixels of the part drawn by this dispatch, relative to pixel_begin; set by raycast()
    uvec2 drawn_end;
    vec3 box_lower;  ///< the drawn part of the volume, voxel space
    vec3 box_upper;
    vec4 cut_plane;       ///< HAS_CUT_PLANE: nothing is drawn where dot(xyz, voxel) + w > 0
    vec3 position_limit;  ///< one ulp below the volume's end, so samples in its upper faces get the last voxel
    vec3 spacing;         ///< reference lengths per voxel
    vec3 inverse_spacing;
    uvec3 page_counts;    ///< size of the directory's grid, in cells (pages.h)
    uint page_shift;      ///< log2 of a grid cell's side in voxels
    uint page_depth;      ///< depth of the directory's nodes
    float step;           ///< reference lengths
    float opacity_limit;  ///< a ray stops at or above it
    float table_lower;    ///< codes; nothing is drawn below
    float table_upper;    ///< codes; nothing is drawn above
    float table_scale;    ///< table coordinate = (code - table_lower) * table_scale
    uint table_entries;
    uint table_depths;   ///< texel of the table where depths begin
    uint opaque_map;     ///< texel of the table where the opaque map begins; 0: no map
    float opaque_scale;  ///< texel of the opaque map = (code - table_lower) * opaque_scale
    uint first_step;     ///< first step of this dispatch's block, for all rays; 0: start of rays
    uint end_step;       ///< KEPT_ALL: only the number of steps matters
    uint is_last_block;
    vec4 background;  ///< linear light, straight alpha
    vec3 light;       ///< unit vector towards the light, volume space
    float ambient;
    float diffuse;
    float specular;
    float shininess;
    float gradient_fade;  ///< codes per reference length
    vec4 depth_plane;     ///< dot(xyz, voxel) + w is 0 where the drawn box starts along the view, and 1 at its end
    vec3 blend_color;     ///< linear light
    float blend_size;     ///< distance blending: share of the blend colour at depth 1
    float blend_rate;     ///< growth of that share with depth: depth^rate
    float slice_black;    ///< slices: the code drawn black
    float slice_scale;    ///< 1 / (codes from black to white)
    float slice_paint;    ///< share of a painted voxel's colour that comes from its group
    vec3 shell_center;    ///< voxel space; centre of the iso-surface's region
    vec3 shell_reach;     ///< half the size of the box, or the ball's radius along each axis; in voxels
    float shell_code;     ///< threshold of the surface
    vec3 shell_color;     ///< linear light
    float shell_opacity;  ///< opacity of one crossing of the surface
    uint points;          ///< texel of the table where the function's points begin
    uint point_count;     ///< integral.comp only
};

SHARED_END
#endif

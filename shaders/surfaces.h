// Opaque surfaces: balls and rods that end rays, found by exact intersection. Lengths and positions are in isotropic
// space: physical positions divided by the reference length, the finest axis of a voxel.
#ifndef SHVR_SURFACES_H
#define SHVR_SURFACES_H
#include "shared.h"

SHARED_BEGIN

/// The convex hull of two balls (a round cone), or one ball where `along` is 0. `from` + `from_rest` is the place of
/// the first one: the rest holds what a float of the size of a large volume loses.
struct Surface {
    vec3 from;
    vec3 from_rest;
    vec3 along;  ///< to the second ball
    float radius_from;
    float radius_to;  ///< neither ball lies in the other
    vec3 color;       ///< linear light
    uint number;      ///< of two at the same length, the lower one is seen
};

/// A box around surfaces. Nodes lie in depth-first order: the next one is the first child, or where there is none
/// `skip`.
struct SurfaceNode {
    vec3 lower;
    vec3 upper;
    uint skip;   ///< the next node that does not lie in this one
    uint begin;  ///< surfaces of a leaf; begin == end elsewhere
    uint end;
};

/// The ray of a pixel goes through a point of the middle plane, in the direction from a point of the near plane to one
/// of the far plane. Points are relative to the middle of that plane, which is what a person looks at, so that nothing
/// is lost there though the volume may be large and the eye far.
struct SurfaceParams {
    vec3 origin;  ///< what points are relative to: origin + origin_rest
    vec3 origin_rest;
    vec3 middle_corner;
    vec3 middle_dx;
    vec3 middle_dy;
    vec3 along_corner;  ///< from the near plane to the far one
    vec3 along_dx;
    vec3 along_dy;
    float begin;   ///< shares of the way from the near plane to the far one: where the camera's clip range begins
    float middle;  ///< where the middle plane is
    float end;     ///< where the clip range ends
    float slack;   ///< boxes are that much larger on each side, more than rounding may be off
    uint node_count;
    vec3 probe_center;  ///< relative to the origin; the probe is one more ball
    float probe_radius;
    vec3 probe_color;  ///< linear light
};

/// The length where a ray meets no surface.
SHARED_CONST float NO_SURFACE = 1e30f;

SHARED_END
#endif

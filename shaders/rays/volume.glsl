// The volume through which rays pass: its bindings, and how the brick and texel of a position are found. Needs KEPT and
// COUNT_WORK. Macros determine the bindings:
//   FILTERED   the atlas is sampled by the device's filter instead of exact arithmetic
//   MASKED     there is a segmentation mask; an unpainted volume binds and fetches none of it
//   PAGED      paged bricks of several levels (pages.h), instead of a leap grid over resident bricks
#include "../raycast.h"
#include "../library/to_int.glsl"
#ifdef PAGED
#include "../pages.h"
#endif

layout(binding = 0, scalar) readonly buffer Params { RaycastParams data; } params_block;
#ifndef PAGED
layout(binding = 1, r32ui) uniform readonly uimage3D leap;
#endif
#ifdef FILTERED
layout(binding = 2) uniform sampler3D atlas;
#else
layout(binding = 2, r32ui) uniform readonly uimage3D atlas;
#endif
// Tables are images, not buffers: one load reads four components of an image, whereas lavapipe would read a buffer one
// lane at a time.
#ifdef MASKED
layout(binding = 5, r8ui) uniform readonly uimage3D mask;
#define MASK_TABLE_BINDING 6
// Row 0, by group: linear RGB and opacity of a full step. Row 1, by group: optical depth of a full step.
layout(binding = 7, rgba32f) uniform readonly image2D groups;
#ifdef PAGED
#define MASK_TABLE_HASHED
#endif
#include "../library/mask.glsl"
#endif

uint density_reads = 0u;
#ifdef PAGED
#define STACKED 16
#endif
#ifdef FILTERED
#include "../library/density_filtered.glsl"
#else
#include "../library/density_exact.glsl"
#endif

#ifdef PAGED
#include "../library/pages.glsl"
#else
// The region that contains a position: a brick, or a region with nothing visible (distance > 0).
struct Place {
    uint distance;   // in cells
    uint slot;
    bool is_painted;  // perhaps
    bool is_missing;  // never
};

Place place_at(const RaycastParams params, vec3 position)
{
    const uint entry = imageLoad(leap, ivec3(to_uint(position) / CELL_SIZE)).x;
    return Place(entry >> LEAP_DISTANCE_SHIFT, entry & LEAP_SLOT_MASK, (entry & LEAP_PAINTED) != 0u, false);
}

Place brick_at(const RaycastParams params, vec3 position)
{
    return place_at(params, position);
}
#endif

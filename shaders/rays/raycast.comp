// Emission-absorption ray-casting of a volume of bricks: one pixel per thread. Its variants differ in their bindings:
//   PAGED FILTERED MASKED   volume.glsl
//   OCCLUDED   ambient light is scaled by the share that reaches the sample (occlusion.h)
//   SURFACED   rays end at opaque surfaces (surfaces.comp)
//   SHELLED    an iso-surface in the region around the probe (shell.glsl); a macro, not a constant, since drivers would
//              compile its code before they drop it
// variants: PAGED FILTERED MASKED OCCLUDED SURFACED SHELLED
//
// march.glsl describes where samples are, and why a ray is drawn in blocks of steps, one dispatch each. Between blocks,
// the target holds the sums of the rays. A ray that nevertheless stops before its end is counted.
//
// If a ray passes more bricks than fit on the device, the ray waits (KEPT_ALL): it stops before a brick that is not on
// the device, marks this brick, and continues in a later dispatch. The samples of a ray and their order do not depend
// on where the ray stops.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "raycast.glsl"

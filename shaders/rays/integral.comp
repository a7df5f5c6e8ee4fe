// Like raycast.comp, but free of errors due to step length: integrates light, to rounding, between half-voxel borders,
// points of the transfer function, and extrema of the density (integral.glsl). For reference pictures. Macros: see
// raycast.comp; FILTERED is not supported, since a filter's rounding exceeds the remaining errors.
// variants: PAGED MASKED OCCLUDED SURFACED SHELLED
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#define INTEGRATED
#include "raycast.glsl"

// Like raycast.comp, but without steps whose length determines errors: integrates light, to rounding, between borders
// of half voxels, points of the transfer function, and turns of the density (integral.glsl). For reference pictures.
// Macros: see raycast.comp; FILTERED is left out, since a filter's rounding exceeds the errors that remain.
// variants: PAGED MASKED OCCLUDED SURFACED SHELLED
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#define INTEGRATED
#include "raycast.glsl"

// As raycast.comp, without steps whose length decides on errors: light is integrated, to rounding, between borders of
// half voxels, points of the transfer function, and turns of the density (integral.glsl). For reference pictures.
// Macros: there; FILTERED is left out, since a filter's rounding exceeds the errors that remain.
// variants: PAGED MASKED OCCLUDED SURFACED SHELLED
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#define INTEGRATED
#include "raycast.glsl"

// Emission-absorption ray-casting through the leap grid: one pixel per thread.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "raycast_body.glsl"

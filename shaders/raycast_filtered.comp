// The ray caster with the device's own trilinear filter.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#define FILTERED
#include "raycast_body.glsl"

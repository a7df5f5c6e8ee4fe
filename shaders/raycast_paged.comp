// The ray caster of bricks that come and go.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#define PAGED
#include "raycast_body.glsl"

// The ray caster of bricks that come and go, with a segmentation mask.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#define PAGED
#define MASKED
#include "raycast_body.glsl"

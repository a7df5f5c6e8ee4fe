// How far rays may leap within bricks that come and go.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "brick_leap_body.glsl"

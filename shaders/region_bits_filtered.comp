// region_bits on an atlas made for the device's filter.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#define FILTERED
#include "region_bits_body.glsl"

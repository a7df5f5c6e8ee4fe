// One word per thread: which voxels of the region are at or above the threshold; every run starts as its own root.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "region_bits_body.glsl"

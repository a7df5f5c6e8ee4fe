// One word per thread: connects the word's runs to touching runs before it (3 of 6 or 13 of 26 neighbours).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "regions.h"

layout(local_size_x = 1, local_size_y = 8, local_size_z = 8) in;
layout(push_constant, scalar) uniform Push { RegionParams params; };
layout(binding = 0, scalar) readonly buffer Bits { uint words[]; } bits;
layout(binding = 1, scalar) coherent buffer Parents { uint of[]; } parents;

#include "forest.glsl"
#include "region.glsl"

// Like find_root, but halves the path for later searches, which keeps chains short in components of any shape. Other
// threads link roots concurrently. A stale parent is still an ancestor, since parents only decrease, and the atomic
// operation in `unite` decides.
uint find_root_halving(uint run)
{
    uint parent = parents.of[run];
    while (parent != run) {
        const uint above = parents.of[parent];
        if (above != parent) atomicMin(parents.of[run], above);
        run = parent;   // same again: a root is its own parent
        parent = above;
    }
    return run;
}

// Links the higher root below the lower one. Retries if another thread has linked a root meanwhile.
void unite(uint a, uint b)
{
    a = find_root_halving(a);
    b = find_root_halving(b);
    while (a != b) {
        const uint high = max(a, b), low = min(a, b);
        const uint before = atomicMin(parents.of[high], low);
        if (before == high) return;
        a = find_root_halving(before);
        b = find_root_halving(low);
    }
}

uint word_at(ivec3 word)
{
    const ivec3 counts = ivec3(params.words_per_row, params.size.yz);
    if (any(lessThan(word, ivec3(0))) || any(greaterThanEqual(word, counts))) return 0u;
    return bits.words[word_index(uvec3(word))];
}

// Unites the runs of `word` at `here` with the runs at (x + dx, y + dy, z + dz), for dx in -1 ... 1.
void unite_with_row(ivec3 here, uint word, int dx, int dy, int dz)
{
    const ivec3 row = here + ivec3(0, dy, dz);
    const uint middle = word_at(row);
    // Bit b of `shifted` is the voxel in the other row that is the neighbour of bit b.
    uint shifted = middle;
    if (dx < 0) shifted = middle << 1 | word_at(row - ivec3(1, 0, 0)) >> 31;
    if (dx > 0) shifted = middle >> 1 | word_at(row + ivec3(1, 0, 0)) << 31;
    const uint touching = word & shifted;
    for (uint starts = touching & ~(touching << 1); starts != 0u; starts &= starts - 1u) {
        const int bit = findLSB(starts);
        const int other = bit + dx;   // -1 ... 32, so the bit may be in a neighbouring word
        const ivec3 other_word = row + ivec3(other < 0 ? -1 : other > 31 ? 1 : 0, 0, 0);
        const uint other_bits = word_at(other_word);
        const uint mine = word_index(uvec3(here)) * 32u + run_start(word, uint(bit));
        const uint theirs = word_index(uvec3(other_word)) * 32u + run_start(other_bits, uint(other & 31));
        unite(mine, theirs);
    }
}

void main()
{
    const uvec3 at = gl_GlobalInvocationID;
    if (outside_region(at)) return;
    const ivec3 here = ivec3(at);
    const uint word = bits.words[word_index(at)];
    if (word == 0u) return;
    if ((word & 1u) != 0u && (word_at(here - ivec3(1, 0, 0)) >> 31) != 0u) unite_with_row(here, word & 1u, -1, 0, 0);
    const int reach = params.connectivity == 26u ? 1 : 0;
    for (int dx = -reach; dx <= reach; ++dx) {
        unite_with_row(here, word, dx, -1, 0);
        unite_with_row(here, word, dx, 0, -1);
        if (reach == 1) {
            unite_with_row(here, word, dx, -1, -1);
            unite_with_row(here, word, dx, 1, -1);
        }
    }
}

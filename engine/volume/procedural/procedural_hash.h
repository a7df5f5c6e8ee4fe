#pragma once
// The noise of procedural volumes: an integer hash, equal on every machine. Goldens depend on its constants.

#include <cstdint>

namespace shvr {

/// The hash function lowbias32 from Chris Wellons' hash prospector (2018), with a bias of 0.17.
constexpr uint32_t mixed(uint32_t bits)
{
    bits ^= bits >> 16;
    bits *= 0x7feb352du;
    bits ^= bits >> 15;
    bits *= 0x846ca68bu;
    bits ^= bits >> 16;
    return bits;
}

/// The part of the hash that is equal for a whole row: hash_of(seed, x, y, z) == mixed(x ^ row_hash(seed, y, z)).
constexpr uint32_t row_hash(uint32_t seed, uint32_t y, uint32_t z)
{
    return mixed(y ^ mixed(z ^ mixed(seed + 0x9e3779b9u)));
}

constexpr uint32_t hash_of(uint32_t seed, uint32_t x, uint32_t y, uint32_t z)
{
    return mixed(x ^ row_hash(seed, y, z));
}

/// Converts a hash to a multiple of 2^-24 in [0, 1).
constexpr double unit_of(uint32_t hash)
{
    return (hash >> 8) * 0x1p-24;
}

}  // namespace shvr

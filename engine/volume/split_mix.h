#pragma once
// Random numbers that are equal on every machine. One thread at a time.

#include <cstdint>

namespace shvr {

/// SplitMix64 (Steele, Lea and Flood, "Fast splittable pseudorandom number generators", 2014).
class SplitMix64 {
public:
    explicit SplitMix64(uint64_t seed) : state_(seed) {}
    uint64_t next()
    {
        uint64_t mixed = (state_ += 0x9e3779b97f4a7c15u);
        mixed = (mixed ^ (mixed >> 30)) * 0xbf58476d1ce4e5b9u;
        mixed = (mixed ^ (mixed >> 27)) * 0x94d049bb133111ebu;
        return mixed ^ (mixed >> 31);
    }
    /// Returns a number below `count`; probabilities are equal up to 2^-32. `count` is at least 1 and below 2^32.
    uint32_t below(uint32_t count) { return uint32_t(((next() >> 32) * count) >> 32); }

private:
    uint64_t state_;
};

}  // namespace shvr

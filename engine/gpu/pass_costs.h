#pragma once
// Learns the cost of passes on this device from measured times, so that a short graph takes one queue submission, and a
// graph so long that a driver would assume a hang is split into several. Does not depend on Vulkan. One thread.

#include <cstdint>
#include <string>
#include <unordered_map>

namespace shvr::gpu {

/// Maximum estimated device time of a submission; only a single tile, or one part of a copy, may take longer. Drivers
/// kill submissions after about two seconds, and some pixels of a picture may cost twenty times more than others.
inline constexpr double MAX_SUBMISSION_MS = 100.0;
/// Estimated time of one part of a copy (copy_parts.h), for a slow bus and a dispatch for each slice of each region.
inline constexpr double COPY_PART_MS = 25.0;

class PassCosts {
public:
    /// Estimates the device time of the given number of threads of a kernel. For a kernel that never ran, it assumes
    /// the worst case on the slowest device: a tile of 128 x 128 rays takes a quarter of a submission, and kernels
    /// without tiles, whose threads do little, take a sixtieth of that per thread.
    double ms(const std::string& kernel, uint64_t threads, bool has_tiles) const;
    /// Records a measured time. The estimate rises at once, but falls slowly: an overestimate by a factor of ten is
    /// corrected within four passes.
    void learn(const std::string& kernel, uint64_t threads, double ms);

private:
    std::unordered_map<std::string, double> ms_per_thread_;
};

}  // namespace shvr::gpu

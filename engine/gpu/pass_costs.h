#pragma once
// Learns the cost of passes on this device from measured times. A short graph then takes one queue submission, and a
// graph so long that a driver would assume a hang is split. Does not depend on Vulkan. One thread.

#include <cstdint>
#include <string>
#include <unordered_map>

namespace shvr::gpu {

/// Maximum estimated device time of a submission. Only a single tile or one part of a copy may take longer. Drivers
/// kill submissions after about two seconds, and a pixel may cost twenty times as much as another pixel of the picture.
inline constexpr double MAX_SUBMISSION_MS = 100.0;
/// Estimated time of one part of a copy (copy_parts.h) on a slow bus, with a dispatch per slice of each region.
inline constexpr double COPY_PART_MS = 25.0;

class PassCosts {
public:
    /// Estimates the device time of the given number of threads of a kernel. For a kernel that has never run, assumes
    /// the worst case on the slowest device: a tile of 128 x 128 rays takes a quarter of a submission, and a kernel
    /// without tiles, whose threads do little, a sixtieth of that time per thread.
    double ms(const std::string& kernel, uint64_t threads, bool has_tiles) const;
    /// Records a measured time. The estimate rises at once but falls slowly: after an overestimate by a factor of ten,
    /// the estimate is right again within four passes.
    void learn(const std::string& kernel, uint64_t threads, double ms);

private:
    std::unordered_map<std::string, double> ms_per_thread_;
};

}  // namespace shvr::gpu

#pragma once
// Learns the cost of passes on this device from measured times, so that a short graph is one queue submission, and a
// graph long enough to look like a hang to a driver is split into several. Knows nothing of Vulkan. One thread.

#include <cstdint>
#include <string>
#include <unordered_map>

namespace shvr::gpu {

/// Maximum estimated device time of one submission, unless a single tile or part of a copy takes longer. Drivers kill
/// submissions after about two seconds, and a pixel may cost twenty times more in one place than in another.
inline constexpr double MAX_SUBMISSION_MS = 100.0;
/// Estimated time of one part of a copy (copy_parts.h), on a slow bus where each slice of each region is a dispatch.
inline constexpr double COPY_PART_MS = 25.0;

class PassCosts {
public:
    /// Estimated device time of that many threads of a kernel. For one that never ran it assumes the worst case on the
    /// slowest device: a tile of 128 x 128 rays takes a quarter of a submission, and a kernel without tiles, whose
    /// threads do little, a sixtieth of that per thread.
    double ms(const std::string& kernel, uint64_t threads, bool has_tiles) const;
    /// Records a measured time. The estimate rises at once; an overestimate by a factor of ten decays within four
    /// passes.
    void learn(const std::string& kernel, uint64_t threads, double ms);

private:
    std::unordered_map<std::string, double> ms_per_thread_;
};

}  // namespace shvr::gpu

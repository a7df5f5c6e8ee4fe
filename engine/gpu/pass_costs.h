#pragma once
// What passes cost on this device, as their times have told, so that a graph goes to the queue in one submission where
// it is short, and in several where a driver might take it for hung. Knows nothing of Vulkan. One thread.

#include <cstdint>
#include <string>
#include <unordered_map>

namespace shvr::gpu {

/// Estimated device time of one submission, unless a single tile or part of a copy takes longer. Drivers end what takes
/// two seconds, and a pixel may cost twenty times more in one place than in another.
inline constexpr double MAX_SUBMISSION_MS = 100.0;
/// Of a part of a copy (copy_parts.h), on a slow bus, and where each slice of each region is a dispatch.
inline constexpr double COPY_PART_MS = 25.0;

class PassCosts {
public:
    /// Estimated device time of that many threads of a kernel. Of one that never ran it assumes the most that may be on
    /// the slowest device: a tile of 128 x 128 rays takes a quarter of a submission, and what has no tiles, since its
    /// threads do little, a sixtieth of that.
    double ms(const std::string& kernel, uint64_t threads, bool has_tiles) const;
    /// They took that long. The estimate rises at once; what was wrong by a factor of ten is forgotten in four passes.
    void learn(const std::string& kernel, uint64_t threads, double ms);

private:
    std::unordered_map<std::string, double> ms_per_thread_;
};

}  // namespace shvr::gpu

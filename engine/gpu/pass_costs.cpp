#include "engine/gpu/pass_costs.h"

#include <algorithm>

namespace shvr::gpu {

double PassCosts::ms(const std::string& kernel, uint64_t threads, bool has_tiles) const
{
    constexpr double RAY_MS = MAX_SUBMISSION_MS / 4 / (128 * 128), OTHER_MS = 1e-4;
    const auto known = ms_per_thread_.find(kernel);
    return double(threads) * (known != ms_per_thread_.end() ? known->second : has_tiles ? RAY_MS : OTHER_MS);
}

void PassCosts::learn(const std::string& kernel, uint64_t threads, double ms)
{
    if (threads == 0 || !(ms >= 0.0)) return;
    // A pass with fewer threads than FULL does not fill the device: its time measures latency instead of throughput.
    constexpr uint64_t FULL = 4096;
    const double seen = ms / double(std::max(threads, FULL));
    const auto [known, is_new] = ms_per_thread_.emplace(kernel, seen);
    if (!is_new) known->second = std::max(seen, 0.5 * known->second);
}

}  // namespace shvr::gpu

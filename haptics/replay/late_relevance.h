#pragma once
// Computes relevance without a window, but with the window's delay: requested when the window's mirror would request it
// (engine/touch/region_wish.h), and felt once the answer would have arrived. For replays and tests. One thread.

#include <functional>
#include <memory>

#include "engine/touch/region_wish.h"
#include "haptics/settings.h"

namespace shvr {

/// Fills `patch` with the relevant voxels around a probe, at or above `threshold`. The function may choose the patch's
/// position and level freely; sequence, time and settings are set afterwards.
using MakeRelevance = std::function<void(const RegionWish& wish, double threshold, RelevancePatch& patch)>;

class LateRelevance {
public:
    /// `every`: number of calls between updates, each felt without delay; 0: updates follow the window's rule.
    LateRelevance(MakeRelevance make, double latency_s, uint32_t every = 0);
    /// Returns the relevance felt now. Call once per tick. `velocity`: the probe's, physical units per second.
    const RelevancePatch& around(const glm::dvec3& velocity, const glm::dvec3& point, const ForceSettings& settings,
                                 double threshold, uint64_t now_ns);
    uint64_t made() const { return made_; }
    /// Call when another servo takes over: a new servo has no relevance yet.
    void swap() { patch_->sequence = next_->sequence = 0; }

private:
    bool is_due(const RegionWish& wish);

    MakeRelevance make_;
    double latency_s_ = 0.0;
    uint32_t every_ = 0, ticks_ = 0;
    std::unique_ptr<RelevancePatch> patch_, next_;  ///< the patch in use; its future replacement (sequence 0: none)
    uint64_t felt_ns_ = 0;                          ///< time when `next_` is felt
    uint64_t made_ = 0;
    double threshold_ = 0.0;
};

}  // namespace shvr

#pragma once
// Relevance computed without a window, as late as in one: asked for by the mirror's rule (engine/touch/region_wish.h)
// and felt once the answer would have arrived. For replays and tests. One thread.

#include <functional>
#include <memory>

#include "engine/touch/region_wish.h"
#include "haptics/settings.h"

namespace shvr {

/// Fills `patch` with the relevant voxels around a probe, at or above `threshold`. It may choose the patch's position
/// and level freely; sequence, time and settings are set afterwards.
using MakeRelevance = std::function<void(const RegionWish& wish, double threshold, RelevancePatch& patch)>;

class LateRelevance {
public:
    /// `every`: number of calls between updates, which are then felt at once; 0: when due.
    LateRelevance(MakeRelevance make, double latency_s, uint32_t every = 0);
    /// The relevance felt now. Call once per tick. `velocity`: of the probe, physical units per second.
    const RelevancePatch& around(const glm::dvec3& velocity, const glm::dvec3& point, const ForceSettings& settings,
                                 double threshold, uint64_t now_ns);
    uint64_t made() const { return made_; }
    /// Another servo knows nothing yet.
    void swap() { patch_->sequence = next_->sequence = 0; }

private:
    bool is_due(const RegionWish& wish);

    MakeRelevance make_;
    double latency_s_ = 0.0;
    uint32_t every_ = 0, ticks_ = 0;
    std::unique_ptr<RelevancePatch> patch_, next_;  ///< felt; on its way, with sequence 0 where none is
    uint64_t felt_ns_ = 0;                          ///< when `next_` is
    uint64_t made_ = 0;
    double threshold_ = 0.0;
};

}  // namespace shvr

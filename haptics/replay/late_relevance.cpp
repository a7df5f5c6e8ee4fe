#include "haptics/replay/late_relevance.h"

#include <algorithm>
#include <utility>

#include "engine/base/finite.h"

namespace shvr {

LateRelevance::LateRelevance(MakeRelevance make, double latency_s, uint32_t every)
    : make_(std::move(make)),
      latency_s_(every > 0 ? 0.0 : latency_s),
      every_(every),
      patch_(std::make_unique<RelevancePatch>()),
      next_(std::make_unique<RelevancePatch>())
{}

const RelevancePatch& LateRelevance::around(const glm::dvec3& velocity, const glm::dvec3& point,
                                            const ForceSettings& settings, double threshold, uint64_t now_ns)
{
    if (threshold != threshold_) {
        swap();
        threshold_ = threshold;
    }
    const RegionWish wish{point, settings.probe_radius, velocity, latency_s_};
    if (next_->sequence == 0 && is_finite(point) && is_due(wish)) {
        make_(wish, threshold, *next_);
        next_->sequence = ++made_;
        felt_ns_ = now_ns + uint64_t(latency_s_ * 1e9);
    }
    if (next_->sequence != 0 && now_ns >= felt_ns_) {
        patch_.swap(next_);
        next_->sequence = 0;
    }
    patch_->time_ns = now_ns;
    patch_->settings = settings.relevance_settings;
    return *patch_;
}

bool LateRelevance::is_due(const RegionWish& wish)
{
    if (every_ > 0) return ticks_++ % every_ == 0 || !patch_->covers(wish.point, wish.radius);
    const glm::dvec3 half = 0.5 * glm::dvec3(patch_->size) * patch_->spacing;
    return is_region_due(*patch_, wish, std::min({half.x, half.y, half.z}) - wish.radius);
}

}  // namespace shvr

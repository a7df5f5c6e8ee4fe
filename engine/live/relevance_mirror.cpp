#include "engine/live/relevance_mirror.h"

#include <pthread.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <utility>

#include "engine/annotation/work/work_offsets.h"
#include "engine/base/waits/waits.h"

namespace shvr {

RelevanceMirror::RelevanceMirror(Ends ends) : ends_(std::move(ends))
{
    SHVR_CHECK(ends_.probe && ends_.publish && ends_.now_ns);
    thread_ = std::thread(&RelevanceMirror::run, this);
    ::pthread_setname_np(thread_.native_handle(), "relevance");
}

RelevanceMirror::~RelevanceMirror()
{
    {
        const std::scoped_lock lock(mutex_);
        ends_now_ = true;
    }
    woken_.notify_all();
    thread_.join();
}

void RelevanceMirror::choose(RelevanceChoice choice)
{
    auto shared = std::make_shared<const RelevanceChoice>(std::move(choice));
    const std::scoped_lock lock(mutex_);
    choice_.swap(shared);
}

std::optional<RelevanceMirror::Wanted> RelevanceMirror::wanted() const
{
    const std::scoped_lock lock(mutex_);
    return wanted_;
}

void RelevanceMirror::offer(const Wanted& wanted, RelevanceBits bits)
{
    {
        const std::scoped_lock lock(mutex_);
        offered_ = Offered{wanted, std::move(bits)};
        is_woken_ = true;
    }
    woken_.notify_all();
}

void RelevanceMirror::decline(const Wanted& wanted)
{
    {
        const std::scoped_lock lock(mutex_);
        declined_ = wanted;
        is_woken_ = true;
    }
    woken_.notify_all();
}

std::string RelevanceMirror::trouble() const
{
    const std::scoped_lock lock(mutex_);
    return trouble_;
}

uint64_t RelevanceMirror::made_on_host() const
{
    const std::scoped_lock lock(mutex_);
    return made_on_host_;
}

// ---- The thread -----------------------------------------------------------------------------------------------------

void RelevanceMirror::run()
{
    while (true) {
        {
            const std::scoped_lock lock(mutex_);
            if (ends_now_) return;
            now_ = choice_;
        }
        const uint64_t now_ns = ends_.now_ns();
        if (now_ && now_->source) {
            const WaitsUntil waits([this] {
                const std::scoped_lock lock(mutex_);
                return ends_now_ || !choice_ || choice_->source != now_->source;
            });
            turn(now_ns);
        }
        sleep_until(now_ns + TURN_NS);
    }
}

void RelevanceMirror::sleep_until(uint64_t until_ns)
{
    if (ends_.wait) return ends_.wait(until_ns);
    const uint64_t now_ns = ends_.now_ns();
    std::unique_lock lock(mutex_);
    if (until_ns > now_ns)
        woken_.wait_for(lock, std::chrono::nanoseconds(until_ns - now_ns), [this] { return ends_now_ || is_woken_; });
    is_woken_ = false;
}

bool RelevanceMirror::is_of(const Wanted& wanted) const
{
    return held_.sequence > 0 && held_.place == wanted.place && held_.threshold == wanted.threshold &&
           held_.settings == wanted.settings && held_.voxels == wanted.voxels;
}

void RelevanceMirror::hold(const Wanted& wanted, RelevanceBits bits, bool is_from_host)
{
    held_.place = wanted.place;
    unlimited_ = std::move(bits);
    limit();
    held_.settings = wanted.settings;
    held_.voxels = wanted.voxels;
    held_.threshold = wanted.threshold;
    held_.is_from_host = is_from_host;
    measure_latency();
    waiting_for_.reset();
}

void RelevanceMirror::limit()
{
    held_.bits = unlimited_;
    apply_limits(now_->limits, now_->source->info().spacing, now_->mask.get(), held_.bits);
    held_.limits += held_.sequence > 0 && now_->limits != limits_;
    limits_ = now_->limits;
    ++held_.sequence;
}

void RelevanceMirror::measure_latency()
{
    if (!waiting_for_) return;
    constexpr double NEWEST_SHARE = 0.25;
    const double took_s = std::min(double(ends_.now_ns() - waiting_since_ns_) * 1e-9, MAX_LATENCY_S);
    latency_s_ += NEWEST_SHARE * (took_s - latency_s_);
}

void RelevanceMirror::take_offer()
{
    std::optional<Offered> offered;
    {
        const std::scoped_lock lock(mutex_);
        offered.swap(offered_);
    }
    // Accepts only the awaited answer: the host may have answered first, or the user's choice may have changed.
    if (!offered || waiting_for_ != offered->wanted || offered->bits.box != offered->wanted.place.box) return;
    if (offered->wanted.settings == now_->settings && offered->wanted.voxels == now_->voxels) {
        hold(offered->wanted, std::move(offered->bits), false);
    }
}

void RelevanceMirror::set_wanted(const std::optional<Wanted>& wanted)
{
    const std::scoped_lock lock(mutex_);
    wanted_ = wanted;
}

void RelevanceMirror::turn(uint64_t now_ns)
{
    take_offer();
    const std::optional<ProbeMotion> probe = ends_.probe();
    const glm::dvec3 checked = probe ? probe->point + probe->velocity : glm::dvec3(NAN);
    if (!std::isfinite(checked.x + checked.y + checked.z)) return;
    // The thread may publish an answer as late as TURN_NS after the answer arrives.
    const double latency_s = latency_s_ + double(TURN_NS) * 1e-9;
    const RegionWish wish{probe->point, now_->radius, probe->velocity, latency_s};
    const Wanted best{relevance_place(*now_->source, wish), now_->threshold, now_->settings, now_->voxels};

    const double finest = std::min({best.place.spacing.x, best.place.spacing.y, best.place.spacing.z});
    const double margin = 0.5 * double(held_.place.box.size().x) * finest - wish.radius;
    const bool is_current = is_of({held_.place, best.threshold, best.settings, best.voxels});
    const bool suits = is_current && held_.place.level <= best.place.level;
    if ((suits && !is_region_due(held_.place, wish, margin)) || is_of(best)) {
        waiting_for_.reset();
        set_wanted({});
    } else {
        // Keeps the pending request as long as the requested cube still suffices.
        const bool still_does = waiting_for_ && waiting_for_->threshold == best.threshold &&
                                waiting_for_->settings == best.settings && waiting_for_->voxels == best.voxels &&
                                waiting_for_->place.covers(wish.point + wish.travel(), wish.radius);
        if (!still_does) {
            if (!waiting_for_) waiting_since_ns_ = now_ns;
            waiting_for_ = best;
        }
        const bool asks_device = now_->has_device && best.place.level == 0 && !now_->limits.unpainted;
        set_wanted(asks_device ? waiting_for_ : std::nullopt);
        const bool is_declined = [&] {
            const std::scoped_lock lock(mutex_);
            return declined_ == waiting_for_;
        }();
        const bool may_try = failed_ns_ == 0 || now_ns - failed_ns_ >= TROUBLE_NS;
        // Gives the device more time as long as the held cube leaves enough margin around the ball.
        const bool is_urgent = !suits || !held_.place.covers(wish.point + wish.travel(), wish.radius);
        const uint64_t patience_ns = is_urgent ? DEVICE_NS : 4 * DEVICE_NS;
        if (may_try && (!asks_device || is_declined || now_ns - waiting_since_ns_ >= patience_ns))
            make_on_host(best, now_ns);
    }
    if (held_.sequence == 0) return;
    if (now_->limits != limits_) limit();
    if (held_.settings == now_->settings && held_.voxels == now_->voxels && held_.threshold == now_->threshold)
        held_.true_at_ns = now_ns;
    ends_.publish(held_);
}

void RelevanceMirror::make_on_host(const Wanted& wanted, uint64_t now_ns)
{
    std::string trouble;
    try {
        hold(wanted,
             relevance_on_host(*source_with_offsets(), wanted.place.level, wanted.place.box, wanted.threshold,
                               now_->limits, now_->mask.get()),
             true);
        failed_ns_ = 0;
    } catch (const std::exception& failure) {
        trouble = failure.what();  // the force fades out, as when the device does not answer
        failed_ns_ = now_ns;
    }
    const std::scoped_lock lock(mutex_);
    wanted_.reset();
    trouble_ = std::move(trouble);
    made_on_host_ += trouble_.empty();
}

std::shared_ptr<const VolumeSource> RelevanceMirror::source_with_offsets()
{
    if (!now_->offsets || now_->offsets->voxels() == 0) return now_->source;
    if (!with_offsets_ || offsets_of_it_ != now_->offsets) {
        with_offsets_ = with_offsets(now_->source, *now_->offsets);
        offsets_of_it_ = now_->offsets;
    }
    return with_offsets_;
}

}  // namespace shvr

#include "engine/workbench/touch/device_tap.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace shvr::ui {

namespace {

glm::dvec3 along(const PlaneHold& plane, const glm::dvec3& vector)
{
    return plane.normal * glm::dot(plane.normal, vector);
}

}  // namespace

bool TapLink::take(RecordedTick& tick)
{
    const uint64_t next = fetched_.load(std::memory_order_relaxed);
    if (next == written_.load(std::memory_order_acquire)) return false;
    tick = ring_[next % RING];
    fetched_.store(next + 1, std::memory_order_release);
    return true;
}

void TapLink::begin_tick() noexcept
{
    is_new_tick_ = true;
    Latest<ForceSettings>* const settings = settings_.load(std::memory_order_acquire);
    if (!settings || !orders_.take()) return;
    const TapOrder& order = orders_.value();
    settings->publish(order.settings.force);  // the servo reads these settings after this call, on this thread
    has_new_settings_ = true;
    if (order.recording != recording_) {
        recording_ = order.recording;
        has_new_settings_ = true;
    }
}

/// Stores the tick's time, which is the first time that the servo requests during the tick.
void TapLink::note_now(uint64_t now_ns) noexcept
{
    if (!std::exchange(is_new_tick_, false)) return;
    now_.tick.now_ns = now_ns;
}

void TapLink::note_read(ReadResult result, const DeviceState& state) noexcept
{
    // Stores the result as the servo sees it: after a failed write, the device is lost until it reports a new state.
    now_.tick.read = !was_written_ && result != ReadResult::fresh ? ReadResult::lost : result;
    now_.tick.state = state;
    if (const Latest<RelevancePatch>* const relevance = relevance_.load(std::memory_order_acquire)) {
        now_.relevance = relevance->value().sequence;  // this is the relevance that the servo has used in this tick
        now_.tick.relevance_time_ns = now_.relevance > 0 ? relevance->value().time_ns : 0;
    }
    if (result != ReadResult::fresh) return;
    if (has_sequence_ && state.sequence - last_sequence_ - 1 < 1000)
        plot_.lost_states += state.sequence - last_sequence_ - 1;
    has_sequence_ = true;
    last_sequence_ = state.sequence;
}

void TapLink::note_write(const glm::dvec3& asked_n, const glm::dvec3& force_n, bool was_written,
                         const DeviceCaps& caps) noexcept
{
    was_written_ = was_written;
    now_.tick.force_n = asked_n;
    const double seconds =
        last_ns_ > 0 && now_.tick.now_ns > last_ns_ ? double(now_.tick.now_ns - last_ns_) * 1e-9 : 0.0;
    last_ns_ = now_.tick.now_ns;
    add_heat(caps.outputs_force ? force_n : glm::dvec3(0.0), std::min(seconds, 1.0), heat_);
    const double most = caps.continuous_force_n * caps.continuous_force_n / (1.0 + HEAT_S / HEAT_WINDOW_S);
    plot_.heat = most > 0.0 ? heat_.square / most : 0.0;
    add_to_plot(glm::length(force_n));
    if (recording_ != 0) put();
    has_new_settings_ = recording_ == 0 && has_new_settings_;  // a recording begins with the settings in force
}

void TapLink::put() noexcept
{
    const uint64_t next = written_.load(std::memory_order_relaxed);
    if (next - fetched_.load(std::memory_order_acquire) >= RING) {
        has_overrun_.store(true, std::memory_order_relaxed);
        return;
    }
    RecordedTick& slot = ring_[next % RING];
    slot.tick = now_.tick;
    slot.caps = now_.caps;
    slot.relevance = now_.relevance;
    slot.recording = recording_;
    slot.has_settings = has_new_settings_;
    if (has_new_settings_) slot.settings = orders_.value().settings;
    written_.store(next + 1, std::memory_order_release);
}

void TapLink::add_to_plot(double force_n) noexcept
{
    bar_ = std::max(bar_, std::isfinite(force_n) ? float(force_n) : 0.0f);
    if (++in_bar_ < TapState::TICKS_A_BAR) return;
    plot_.force_n[plot_.bars++ % TapState::BARS] = bar_;
    bar_ = 0.0f;
    in_bar_ = 0;
    state_.publish(plot_);
}

ReadResult DeviceTap::read(DeviceState& state) noexcept
{
    const ReadResult result = device_->read(raw_);
    if (result == ReadResult::fresh) {
        state = raw_;
        const PlaneHold& plane = link_->plane();
        state.jump += plane.count;
        if (plane.is_on) state.position_m -= along(plane, state.position_m - plane.point_m);
    }
    link_->note_read(result, state);
    return result;
}

bool DeviceTap::write(const glm::dvec3& force_n, uint32_t sequence) noexcept
{
    const PlaneHold& plane = link_->plane();
    const glm::dvec3 given_n = plane.is_on ? force_n - along(plane, force_n) : force_n;
    const bool was_written = device_->write(given_n, sequence);
    link_->note_write(force_n, given_n, was_written, device_->caps());
    return was_written;
}

TappedServo::TappedServo(std::shared_ptr<HapticDevice> with, std::unique_ptr<Pacing> pacing, uint32_t recording)
    : device(std::move(with)),
      link(std::make_shared<TapLink>(recording)),
      servo(std::make_unique<DeviceTap>(device, link), std::make_unique<TapPacing>(std::move(pacing), link), {})
{
    link->connect(servo.settings(), servo.relevance());
}

void TappedServo::publish_relevance()
{
    link->relevance_log().note(relevance());
    servo.relevance().publish();
}

}  // namespace shvr::ui

#include "haptics/servo.h"

#include <pthread.h>
#include <sched.h>
#include <sys/prctl.h>
#include <time.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "engine/base/error.h"
#include "haptics/kept_memory.h"

namespace shvr {
namespace {

constexpr int SERVO_PRIORITY = 80;
constexpr uint64_t SECOND_NS = 1'000'000'000;
constexpr size_t STACK_BYTES = size_t{128} << 10;  ///< maximum used in a tick

class RealPacing : public Pacing {
public:
    uint64_t now_ns() noexcept override
    {
        timespec time{};
        ::clock_gettime(CLOCK_MONOTONIC, &time);
        return uint64_t(time.tv_sec) * SECOND_NS + uint64_t(time.tv_nsec);
    }
    void wait_until(uint64_t deadline_ns) noexcept override
    {
        timespec deadline{};
        deadline.tv_sec = time_t(deadline_ns / SECOND_NS);
        deadline.tv_nsec = long(deadline_ns % SECOND_NS);
        // A signal may interrupt the sleep; any other error would be a bug here. In both cases, checks the clock again.
        while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr) != 0 && now_ns() < deadline_ns) {
        }
    }
};

uint64_t since(uint64_t then_ns, uint64_t now_ns)
{
    return now_ns > then_ns ? now_ns - then_ns : 0;
}

}  // namespace

std::unique_ptr<Pacing> real_pacing()
{
    return std::make_unique<RealPacing>();
}

void TimeHistogram::add(uint64_t nanoseconds) noexcept
{
    const auto bin = size_t(std::bit_width(nanoseconds / 1000));
    ++counts[std::min(bin, BINS - 1)];
    worst_ns = std::max(worst_ns, nanoseconds);
}

uint64_t TimeHistogram::total() const noexcept
{
    uint64_t sum = 0;
    for (const uint64_t count : counts) sum += count;
    return sum;
}

double TimeHistogram::quantile_us(double share) const noexcept
{
    const double wanted = share * double(total());
    uint64_t sum = 0;
    for (size_t bin = 0; bin < BINS; ++bin) {
        sum += counts[bin];
        if (sum == 0 || double(sum) < wanted) continue;
        // The last bin has no upper end, so the worst value measured is returned for it.
        return bin + 1 < BINS ? double(uint64_t{1} << bin) : double(worst_ns) * 1e-3;
    }
    return 0.0;
}

Servo::Servo(std::unique_ptr<HapticDevice> device, std::unique_ptr<Pacing> pacing, const Options& options)
    : device_(std::move(device)),
      pacing_(std::move(pacing)),
      options_(options),
      growth_(std::make_unique<GrowthMemory>())
{
    SHVR_CHECK(device_ && pacing_);
    SHVR_CHECK(options.rate_hz >= 1 && options.rate_hz <= 100'000, options.rate_hz);
    thread_ = std::thread(&Servo::run, this);
    ::pthread_setname_np(thread_.native_handle(), "servo");
    if (options.realtime) {
        sched_param parameters{};
        parameters.sched_priority = SERVO_PRIORITY;
        is_realtime_ = ::pthread_setschedparam(thread_.native_handle(), SCHED_FIFO, &parameters) == 0;
    }
}

Servo::~Servo()
{
    running_ = false;
    thread_.join();
}

void Servo::run() noexcept
{
    ::prctl(PR_SET_TIMERSLACK, 1UL);  // wakes up to 50 us earlier than by default; no effect under SCHED_FIFO
    const KeptMemory shared(this, sizeof *this), growth(growth_.get(), sizeof *growth_);
    const KeptMemory stack(static_cast<std::byte*>(__builtin_frame_address(0)) - STACK_BYTES, STACK_BYTES);
    const bool has_code = keep_code();
    keeps_memory_ = shared.is_kept() && growth.is_kept() && stack.is_kept() && has_code;
    const uint64_t period_ns = SECOND_NS / options_.rate_hz;
    ForceMemory memory;
    DeviceState device;
    TimeHistogram lateness, duration, relevance_age;
    uint64_t ticks = 0, late_ticks = 0;
    bool wrote = true, has_settings = false;

    uint64_t deadline_ns = pacing_->now_ns() + period_ns;
    while (running_) {
        pacing_->wait_until(deadline_ns);
        const uint64_t now_ns = pacing_->now_ns();
        const uint64_t late_ns = since(deadline_ns, now_ns);
        lateness.add(late_ns);
        if (late_ns > period_ns) ++late_ticks;
        deadline_ns += period_ns * (1 + late_ns / period_ns);  // missed ticks are skipped

        has_settings = settings_.take() || has_settings;
        relevance_.take();
        const ForceSettings& settings = settings_.value();
        const RelevancePatch& relevance = relevance_.value();  // 256 KiB, used in place
        const DeviceCaps caps = device_->caps();
        const ReadResult read = device_->read(device);
        const ReadResult result = !wrote && read != ReadResult::fresh ? ReadResult::lost : read;
        const ForceStep force = step(settings, caps, result, device, relevance, now_ns, memory, *growth_);
        ++ticks;
        wrote = device_->write(force.force_n, force.sequence);

        if (settings.assistance && relevance.sequence != 0) relevance_age.add(since(relevance.time_ns, now_ns));
        duration.add(since(now_ns, pacing_->now_ns()));
        ServoState& state = state_.writing();
        state.time_ns = now_ns;
        state.ticks = ticks;
        state.late_ticks = late_ticks;
        state.device = device;
        state.step = force;
        state.caps = caps;
        state.lateness = lateness;
        state.duration = duration;
        state.relevance_age = relevance_age;
        state.relevance_time_ns = relevance.sequence != 0 ? relevance.time_ns : 0;
        state_.publish();
        place_.publish({.point = force.probe,
                        .velocity = force.velocity,
                        .is_known = has_settings && !(force.flags & FORCE_NO_DEVICE)});
    }
    device_->write(glm::dvec3(0.0), memory.sent.sequence + 1);
}

}  // namespace shvr

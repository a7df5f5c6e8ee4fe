#include "haptics/replay/replay.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <memory>

#include "engine/base/error.h"
#include "engine/base/finite.h"
#include "haptics/replay/late_relevance.h"

namespace shvr {
namespace {

constexpr uint64_t FNV_BASIS = 14695981039346656037ull, FNV_PRIME = 1099511628211ull;

void add_bits(double value, uint64_t& hash)
{
    for (uint64_t bits = std::bit_cast<uint64_t>(value), i = 0; i < 8; ++i, bits >>= 8)
        hash = (hash ^ (bits & 255)) * FNV_PRIME;
}

bool same_bits(const glm::dvec3& a, const glm::dvec3& b)
{
    return std::bit_cast<uint64_t>(a.x) == std::bit_cast<uint64_t>(b.x) &&
           std::bit_cast<uint64_t>(a.y) == std::bit_cast<uint64_t>(b.y) &&
           std::bit_cast<uint64_t>(a.z) == std::bit_cast<uint64_t>(b.z);
}

ForceSettings chosen(const TraceSettings& settings, const ReplayOptions& options)
{
    ForceSettings force = settings.force;
    force.mode = options.mode.value_or(force.mode);
    force.law = options.law.value_or(force.law);
    force.stiffness = options.stiffness.value_or(force.stiffness);
    force.damping = options.damping.value_or(force.damping);
    force.probe_radius = options.probe_radius.value_or(force.probe_radius);
    force.surface_share = options.surface_share.value_or(force.surface_share);
    force.strength = options.strength.value_or(force.strength);
    return force;
}

/// The device of a replay: gives the trace's answers, or those of a modelled device that is led along the trace's path.
class Player {
public:
    Player(const Trace& trace, const ReplayOptions& options) : trace_(trace)
    {
        if (!options.touch) return;
        model_ = *options.touch;
        model_.tick_s = 1.0 / trace.rate_hz;
        model_.jitter_s = std::min(model_.jitter_s, 0.5 * model_.tick_s);
        touch_ = std::make_unique<ModelledTouch>(model_);
    }
    void swap()
    {
        if (!touch_) return;
        work_before_j_ += touch_->work_j();
        touch_ = std::make_unique<ModelledTouch>(model_);
    }
    DeviceCaps caps(size_t tick)
    {
        for (; caps_ != trace_.later_caps.size() && trace_.later_caps[caps_].from_tick <= tick; ++caps_) {
        }
        return touch_ ? touch_->caps() : caps_ > 0 ? trace_.later_caps[caps_ - 1].caps : trace_.caps;
    }
    ReadResult read(const TraceTick& tick, DeviceState& state)
    {
        if (!touch_) {
            state = tick.state;
            return tick.read;
        }
        if (is_finite(tick.state.position_m)) wish_m_ = tick.state.position_m;
        // The modelled device starts where the trace starts.
        touch_->wish().publish({.position_m = wish_m_, .buttons = tick.state.buttons, .jump = tick.state.jump + 1});
        return touch_->read(state);
    }
    void write(const ForceStep& force)
    {
        if (touch_) touch_->write(force.force_n, force.sequence);
    }
    std::optional<double> work_j() const
    {
        return touch_ ? std::optional(work_before_j_ + touch_->work_j()) : std::nullopt;
    }

private:
    const Trace& trace_;
    size_t caps_ = 0;  ///< changes of limits so far
    TouchModel model_;
    std::unique_ptr<ModelledTouch> touch_;
    double work_before_j_ = 0.0;  ///< sum over earlier devices
    glm::dvec3 wish_m_{0.0};
};

/// Supplies the relevance that the servo had in the recorded session, tick by tick.
class RecordedRelevance {
public:
    explicit RecordedRelevance(const Trace& trace)
        : trace_(trace), now_(std::make_unique<RelevancePatch>()), next_(std::make_unique<RelevancePatch>())
    {}
    void swap() { now_->sequence = 0; }
    const RelevancePatch& at(size_t tick)
    {
        for (; read_ < trace_.relevance.size() && trace_.relevance[read_].from_tick <= tick; ++read_) {
            if (!read_relevance(trace_.relevance[read_], *now_, *next_))
                fail("the trace: relevance ", read_, " before tick ", tick, " does not fit its words");
            now_.swap(next_);
        }
        now_->time_ns = trace_.ticks[tick].relevance_time_ns;
        return *now_;
    }
    uint64_t read() const { return read_; }

private:
    const Trace& trace_;
    size_t read_ = 0;
    std::unique_ptr<RelevancePatch> now_, next_;
};

/// Sums up the steps of a replay.
class Tally {
public:
    explicit Tally(ReplayResult& result) : result_(result) { result_.hash = FNV_BASIS; }

    /// Switches to another device, whose first force is not compared or combined with a force of the previous device.
    void swap()
    {
        ++result_.swaps;
        last_force_ = glm::dvec3(0.0);
        has_last_ = false;
    }

    void add(const TraceTick& tick, const DeviceState& state, const ForceStep& step)
    {
        // The force of the last tick was in effect during this motion.
        if (has_last_ && is_finite(state.position_m))
            result_.energy_j += glm::dot(last_force_, state.position_m - last_position_);
        has_last_ = is_finite(state.position_m);
        last_position_ = state.position_m;
        result_.largest_step_n = std::max(result_.largest_step_n, glm::distance(step.force_n, last_force_));
        last_force_ = step.force_n;
        result_.largest_force_n = std::max(result_.largest_force_n, glm::length(last_force_));
        for (int axis = 0; axis < 3; ++axis) add_bits(last_force_[axis], result_.hash);
        if (tick.force_n) {
            ++result_.told;
            result_.told_equal += same_bits(*tick.force_n, last_force_);
        }
        if (step.in_contact) {
            const glm::dvec3 away = step.proxy - step.probe;
            squares_ += glm::dot(away, away);
            ++result_.contact_ticks;
        }
        result_.objects = step.objects;
    }

    /// Returns the root mean square of the distances between proxy and probe in contact.
    double proxy_rms() const
    {
        return result_.contact_ticks > 0 ? std::sqrt(squares_ / double(result_.contact_ticks)) : 0.0;
    }

private:
    ReplayResult& result_;
    glm::dvec3 last_force_{0.0}, last_position_{0.0};
    bool has_last_ = false;
    double squares_ = 0.0;
};

}  // namespace

bool replays_relevance(const Trace& trace, const ReplayOptions& options)
{
    return trace.holds_relevance && !options.touch && !options.relevance_anew;
}

ReplayResult replay_trace(const Trace& trace, const ReplayOptions& options, const MakeRelevance& make_relevance,
                          bool keep_steps)
{
    using Clock = std::chrono::steady_clock;
    Player player(trace, options);
    LateRelevance mirror(make_relevance, options.relevance_latency_s, options.relevance_every);
    RecordedRelevance recorded(trace);
    const bool is_recorded = replays_relevance(trace, options);
    if (!is_recorded && !make_relevance) fail("the trace holds no relevance that fits; expected a volume");
    ForceMemory memory;
    auto growth = std::make_unique<GrowthMemory>();
    const uint64_t period_ns = 1'000'000'000 / trace.rate_hz;
    ReplayResult result;
    Tally tally(result);
    result.tick_ns.reserve(trace.ticks.size());
    auto settings = trace.settings.begin();
    auto swap = trace.swaps.begin();
    DeviceState state;
    ForceStep step_now;
    for (size_t i = 0; i < trace.ticks.size(); ++i) {
        const TraceTick& tick = trace.ticks[i];
        while (settings + 1 != trace.settings.end() && (settings + 1)->from_tick <= i) ++settings;
        const ForceSettings force_settings = chosen(*settings, options);
        const bool is_swapped = swap != trace.swaps.end() && *swap == i;
        if (is_swapped) {
            ++swap;
            tally.swap();
            player.swap();
            recorded.swap();
            mirror.swap();
            step_now = {};
            memory = {};
            growth = std::make_unique<GrowthMemory>();
            state = {};
        }
        if (i > 0 && !is_swapped && tick.now_ns > trace.ticks[i - 1].now_ns + 2 * period_ns) ++result.late;

        const ReadResult read = player.read(tick, state);
        const glm::dvec3 probe = force_settings.workspace.to_point(state.position_m);
        const RelevancePatch& patch =
            is_recorded ? recorded.at(i)
                        : mirror.around(step_now.velocity, probe, force_settings, settings->threshold, tick.now_ns);
        const Clock::time_point begin = Clock::now();
        step_now = step(force_settings, player.caps(i), read, state, patch, tick.now_ns, memory, *growth);
        result.tick_ns.push_back(uint64_t(std::chrono::nanoseconds(Clock::now() - begin).count()));
        player.write(step_now);
        tally.add(tick, state, step_now);
        result.assisted_ticks += force_settings.assistance;
        if (keep_steps) result.steps.push_back(step_now);
        if (options.note_tick)
            options.note_tick({.now_ns = tick.now_ns,
                               .read = read,
                               .device = state,
                               .step = step_now,
                               .energy_j = player.work_j().value_or(result.energy_j)});
    }
    result.is_recorded = is_recorded;
    result.ticks = trace.ticks.size();
    result.patches = is_recorded ? recorded.read() : mirror.made();
    result.energy_j = player.work_j().value_or(result.energy_j);
    result.proxy_rms = tally.proxy_rms();
    return result;
}

}  // namespace shvr

#include "haptics/hid/hid_link.h"

#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/latest.h"
#include "haptics/hid/hid_protocol.h"

namespace shvr {
namespace {

using SteadyClock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr int READ_TIMEOUT_MS = 10;  ///< short, so that shutdown never has to interrupt a read
constexpr milliseconds REOPEN_EVERY{15};
constexpr milliseconds LOOK_EVERY{5};         ///< interval at which threads check whether they must end
constexpr int MAX_REPORTS_A_DRAIN = 256;      ///< upper bound, so that a flood of reports cannot delay the newest
constexpr uint64_t MAX_STEP_NS = 20'000'000;  ///< longest step of rate control: no leap after a pause
// With a rate-control device, the probe yields to forces as with the mouse: 75 N/m, settling within about 10 ms.
constexpr double GIVE_WAY = 75.0;
constexpr double SETTLE_S = 0.01;
constexpr int LINK_PRIORITY = 81;  ///< above the servo's priority, since both threads run briefly and then wait

/// Passed from the reader to the servo.
struct Reading {
    uint64_t connection = 0;  ///< number of the connection that the state was read on, from 1
    DeviceState state;
};

/// Passed from the servo to the writer.
struct Command {
    glm::dvec3 force_n{0.0};
    uint32_t sequence = 0;
};

uint32_t bits_of(const HidProfile& profile, HidQuantity quantity)
{
    const HidField* field = profile.find_input(quantity);
    return field ? field->bits : 32;
}

uint64_t steady_ns()
{
    return uint64_t(SteadyClock::now().time_since_epoch() / std::chrono::nanoseconds(1));
}

/// Decodes the reports of one connection: unwraps counters that overflow, and combines the data of several reports.
class Decoder {
public:
    explicit Decoder(const HidProfile& profile)
        : profile_(profile),
          clock_(profile.find_input(HidQuantity::time)),
          sequence_(bits_of(profile, HidQuantity::sequence)),
          force_sequence_(bits_of(profile, HidQuantity::force_sequence)),
          time_(bits_of(profile, HidQuantity::time))
    {}
    /// Returns null if the report is malformed (see `is_malformed()`), or if no report has contained a position yet.
    std::optional<DeviceState> next(std::span<const uint8_t> report)
    {
        is_malformed_ = false;
        const std::optional<HidInput> input = decode(profile_, report);
        is_malformed_ = !input && !is_ignored(profile_, report);
        if (!input) return std::nullopt;
        ++reports_;
        // A report without a time gets its arrival time; a report without a sequence number gets a running number.
        if (!clock_) state_.time_ns = steady_ns();
        if (input->time) state_.time_ns = uint64_t(double(time_.next(*input->time)) * clock_->scale * 1e9 + 0.5);
        if (!profile_.find_input(HidQuantity::sequence)) state_.sequence = reports_;
        if (input->sequence) state_.sequence = uint32_t(sequence_.next(*input->sequence));
        if (input->force_sequence) state_.force_sequence = uint32_t(force_sequence_.next(*input->force_sequence));
        state_.position_m = input->position_m.value_or(state_.position_m);
        state_.rotation = input->rotation.value_or(state_.rotation);
        state_.buttons = input->buttons.value_or(state_.buttons);
        state_.calibrated = input->calibrated.value_or(state_.calibrated);
        if (profile_.rate && input->rate) state_.rate = shaped(*profile_.rate, *input->rate);
        if (profile_.rate && input->turn_rate) state_.turn_rate = shaped(*profile_.rate, *input->turn_rate);
        has_place_ = has_place_ || input->position_m || profile_.rate;
        return has_place_ ? std::optional(state_) : std::nullopt;
    }

    bool is_malformed() const { return is_malformed_; }

private:
    const HidProfile& profile_;
    const HidField* clock_;
    Unwrapped sequence_, force_sequence_, time_;
    uint32_t reports_ = 0;
    bool has_place_ = false, is_malformed_ = false;
    DeviceState state_;
};

/// Position reached by integrating the speeds.
struct RateMotion {
    glm::dvec3 wish_m{0.0}, given_way_m{0.0};
    glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
    uint64_t connection = 0, time_ns = 0, heard_ns = 0;
    uint32_t sequence = 0;
    DeviceState heard;
};

class HidLink : public HapticDevice {
public:
    HidLink(const HidProfile& profile, std::unique_ptr<HidPort> port, HidOpener reopen, const HidLinkOptions& options)
        : profile_(profile), reopen_(std::move(reopen)), port_(std::move(port)), connection_(1)
    {
        SHVR_CHECK(port_ && !profile_.inputs.empty());
        may_force_ = options.allow_force && profile_.verified && profile_.output.has_value();
        now_ns_ = options.now_ns ? options.now_ns : steady_ns;
        caps_.publish(ask_limits(*port_));
        reader_ = std::thread(&HidLink::read_reports, this);
        writer_ = std::thread(&HidLink::write_reports, this);
        name_thread(reader_, "hid reader", options.realtime);
        name_thread(writer_, "hid writer", options.realtime);
    }
    ~HidLink() override
    {
        is_running_ = false;
        wake_writer();
        writer_.join();  // stop the writer first: its last report switches the force off and needs the port
        reader_.join();
    }

    // ---- The servo's side ----

    DeviceCaps caps() const noexcept override
    {
        caps_.take();
        return caps_.value();
    }
    const char* trouble() const noexcept override { return connection_ == 0 ? "the device was unplugged" : ""; }
    ReadResult read(DeviceState& state) noexcept override
    {
        const uint64_t connection = connection_;
        if (connection == 0) return ReadResult::lost;
        if (profile_.rate) return move_on(connection, state);
        if (readings_.take() && readings_.value().connection == connection) {
            state = readings_.value().state;
            malformed_seen_ = malformed_;
            return ReadResult::fresh;
        }
        const uint32_t before = std::exchange(malformed_seen_, malformed_.load());
        return before == malformed_seen_ ? ReadResult::stale : ReadResult::malformed;
    }
    bool write(const glm::dvec3& force_n, uint32_t sequence) noexcept override
    {
        force_n_ = force_n;
        commands_.publish({force_n, sequence});
        wake_writer();
        return connection_ != 0;
    }

private:
    /// For rate control: advances the position by the latest speeds.
    ReadResult move_on(uint64_t connection, DeviceState& state) noexcept
    {
        const uint64_t now = now_ns_();
        RateMotion& motion = motion_;
        if (std::exchange(motion.connection, connection) != connection) motion.heard = {};
        if (readings_.take() && readings_.value().connection == connection) {
            motion.heard = readings_.value().state;
            motion.heard_ns = now;
        }
        const bool rests = now - motion.heard_ns > uint64_t{profile_.rate->rest_ms} * 1'000'000;
        if (rests) motion.heard.rate = motion.heard.turn_rate = glm::dvec3(0.0);
        const uint64_t passed = now > motion.time_ns ? now - motion.time_ns : 0;
        const double dt = motion.time_ns == 0 ? 0.0 : double(std::min(passed, MAX_STEP_NS)) * 1e-9;
        motion.time_ns = now;

        const DeviceCaps limits = caps();
        motion.wish_m = glm::clamp(motion.wish_m + motion.heard.rate * (profile_.rate->speed * dt),
                                   limits.usable_lower_m, limits.usable_upper_m);
        const glm::dvec3 wanted = is_finite(force_n_) ? force_n_ / GIVE_WAY : glm::dvec3(0.0);
        motion.given_way_m += (wanted - motion.given_way_m) * -std::expm1(-dt / SETTLE_S);
        const glm::dvec3 turn = motion.heard.turn_rate * (profile_.rate->turn_speed * dt);
        if (const double angle = glm::length(turn); angle > 0.0)
            motion.rotation = glm::normalize(glm::angleAxis(angle, turn / angle) * motion.rotation);

        state = motion.heard;
        state.time_ns = now;
        state.sequence = ++motion.sequence;
        state.position_m = motion.wish_m + motion.given_way_m;
        state.rotation = motion.rotation;
        return ReadResult::fresh;
    }

    static void name_thread(std::thread& thread, const char* name, bool realtime)
    {
        ::pthread_setname_np(thread.native_handle(), name);
        sched_param parameters{};
        parameters.sched_priority = LINK_PRIORITY;
        if (realtime) ::pthread_setschedparam(thread.native_handle(), SCHED_FIFO, &parameters);
    }
    /// One futex call; never waits.
    void wake_writer() noexcept
    {
        wake_.fetch_add(1);
        wake_.notify_one();
    }

    /// Reads the limits of the device on the port, which may be a different device after a reconnection.
    DeviceCaps ask_limits(HidPort& port) const
    {
        DeviceCaps caps = profile_.limits;
        std::array<uint8_t, 1 + MAX_REPORT_BYTES> report{};
        const int size = profile_.feature ? port.read_feature(profile_.feature->id, report) : 0;
        if (size > 0) {
            // hidapi puts the report's id in the first byte even if reports are unnumbered.
            const std::span<const uint8_t> bytes(report.data(), size_t(size));
            caps = decode_feature(profile_, profile_.feature->id == 0 ? bytes.subspan(1) : bytes);
        }
        caps.outputs_force = may_force_;
        caps.tells_force_sequence = profile_.find_input(HidQuantity::force_sequence) != nullptr;
        return caps;
    }

    // ---- The reader's thread ----

    std::shared_ptr<HidPort> port()
    {
        const std::lock_guard lock(port_mutex_);
        return port_;
    }
    /// Replaces the port. A write in progress keeps the old port alive until that write returns.
    void set_port(std::shared_ptr<HidPort> port)
    {
        const std::lock_guard lock(port_mutex_);
        port_ = std::move(port);
        write_failed_ = false;
    }
    /// Drops the port after a failed write, unless the reader has already replaced or dropped it.
    void report_failed_write(const std::shared_ptr<HidPort>& port)
    {
        const std::lock_guard lock(port_mutex_);
        if (port_ == port) write_failed_ = true;
    }

    void read_reports()
    {
        uint64_t connections = 1;
        while (is_running_) {
            if (const std::shared_ptr<HidPort> open = port()) {
                read_while_there(*open, connections);
                if (!is_running_) return;  // keep the port: the writer still needs it for its last report
                connection_ = 0;
                set_port(nullptr);
                continue;
            }
            const SteadyClock::time_point next_try = SteadyClock::now() + REOPEN_EVERY;
            while (is_running_ && SteadyClock::now() < next_try) std::this_thread::sleep_for(LOOK_EVERY);
            if (!is_running_) return;
            if (std::unique_ptr<HidPort> found = reopen_()) {
                caps_.publish(ask_limits(*found));
                set_port(std::move(found));
                connection_ = ++connections;
            }
        }
    }

    void read_while_there(HidPort& port, uint64_t connection)
    {
        Decoder decoder(profile_);
        std::array<uint8_t, 2 + MAX_REPORT_BYTES> report{};  // one byte more than needed, to detect longer reports
        while (is_running_ && !write_failed_) {
            std::optional<DeviceState> newest;
            int timeout_ms = READ_TIMEOUT_MS;
            for (int count = 0; count < MAX_REPORTS_A_DRAIN; ++count, timeout_ms = 0) {
                const int size = port.read(report, timeout_ms);
                if (size < 0) return;
                if (size == 0) break;
                if (const auto state = decoder.next({report.data(), size_t(size)}))
                    newest = state;
                else if (decoder.is_malformed())
                    ++malformed_;
            }
            if (!newest) continue;
            readings_.writing() = {connection, *newest};
            readings_.publish();
        }
    }

    // ---- The writer's thread ----

    void write_reports()
    {
        uint32_t seen = 0;
        while (is_running_) {
            wake_.wait(seen);
            seen = wake_;
            if (commands_.take()) send(commands_.value(), may_force_);
        }
        send({{}, commands_.value().sequence + 1}, false);
    }

    void send(const Command& command, bool enabled)
    {
        // An unverified device gets no output report at all, since the effect of such a report is unknown.
        if (!profile_.verified || !profile_.output || write_failed_) return;
        const std::shared_ptr<HidPort> open = port();
        if (open && !open->write(encode(profile_, command.force_n, command.sequence, enabled).span()))
            report_failed_write(open);
    }

    const HidProfile profile_;
    const HidOpener reopen_;
    bool may_force_ = false;
    uint64_t (*now_ns_)() = steady_ns;

    std::mutex port_mutex_;  ///< guards the port between reader and writer; the servo never takes it
    std::shared_ptr<HidPort> port_;
    std::atomic<uint64_t> connection_;  ///< 0: none
    std::atomic<bool> is_running_{true}, write_failed_{false};
    std::atomic<uint32_t> malformed_{0}, wake_{0};
    uint32_t malformed_seen_ = 0;  ///< used by the servo's thread only, like the next two members
    RateMotion motion_;
    glm::dvec3 force_n_{0.0};

    Latest<Reading> readings_;
    Latest<Command> commands_;
    mutable Latest<DeviceCaps> caps_;  ///< passed from the reader to the servo; the constructor sets the first
    std::thread reader_, writer_;
};

}  // namespace

std::unique_ptr<HapticDevice> make_hid_link(const HidProfile& profile, std::unique_ptr<HidPort> port, HidOpener reopen,
                                            const HidLinkOptions& options)
{
    return std::make_unique<HidLink>(profile, std::move(port), std::move(reopen), options);
}

}  // namespace shvr

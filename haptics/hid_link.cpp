#include "haptics/hid_link.h"

#include <pthread.h>
#include <sched.h>

#include <array>
#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/latest.h"
#include "haptics/hid_protocol.h"

namespace shvr {
namespace {

using SteadyClock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr int READ_TIMEOUT_MS = 10;  ///< so that shutdown never has to interrupt a read
constexpr milliseconds REOPEN_EVERY{50};
constexpr int MAX_REPORTS_A_DRAIN = 256;  ///< a device that floods us must not delay the newest report
constexpr int LINK_PRIORITY = 81;         ///< above the servo's: both are short and then wait

/// Passed from the reader to the servo.
struct Reading {
    uint64_t connection = 0;  ///< connection it was read on, counted from 1
    DeviceState state;
};

/// Passed from the servo to the writer.
struct Command {
    glm::dvec3 force_n{0.0};
    uint32_t sequence = 0;
};

uint32_t bits_of(const HidReport& report, HidQuantity quantity)
{
    const HidField* field = report.find(quantity);
    return field ? field->bits : 32;
}

/// Extends the counters of one connection past their overflows.
class Decoder {
public:
    explicit Decoder(const HidProfile& profile)
        : profile_(profile),
          sequence_(bits_of(*profile.input, HidQuantity::sequence)),
          force_sequence_(bits_of(*profile.input, HidQuantity::force_sequence)),
          time_(bits_of(*profile.input, HidQuantity::time))
    {}
    std::optional<DeviceState> next(std::span<const uint8_t> report)
    {
        const std::optional<HidInput> input = decode(profile_, report);
        if (!input) return std::nullopt;
        ++reports_;
        const HidReport& layout = *profile_.input;
        DeviceState state;
        // Reports without a time or a sequence number get one on arrival.
        const HidField* clock = layout.find(HidQuantity::time);
        state.time_ns = clock ? uint64_t(double(time_.next(input->time)) * clock->scale * 1e9 + 0.5)
                              : uint64_t(SteadyClock::now().time_since_epoch() / std::chrono::nanoseconds(1));
        state.sequence = layout.find(HidQuantity::sequence) ? uint32_t(sequence_.next(input->sequence)) : reports_;
        state.force_sequence = uint32_t(force_sequence_.next(input->force_sequence));
        state.position_m = input->position_m;
        state.rotation = input->rotation;
        state.buttons = input->buttons;
        state.calibrated = input->calibrated;
        return state;
    }

private:
    const HidProfile& profile_;
    Unwrapped sequence_, force_sequence_, time_;
    uint32_t reports_ = 0;
};

class HidLink : public HapticDevice {
public:
    HidLink(const HidProfile& profile, std::unique_ptr<HidPort> port, HidOpener reopen, const HidLinkOptions& options)
        : profile_(profile), reopen_(std::move(reopen)), port_(std::move(port)), connection_(1)
    {
        SHVR_CHECK(port_ && profile_.input);
        caps_ = ask_limits(*port_);
        may_force_ = options.allow_force && profile_.verified && profile_.output.has_value();
        caps_.outputs_force = may_force_;
        reader_ = std::thread(&HidLink::read_reports, this);
        writer_ = std::thread(&HidLink::write_reports, this);
        name_thread(reader_, "hid reader", options.realtime);
        name_thread(writer_, "hid writer", options.realtime);
    }
    ~HidLink() override
    {
        is_running_ = false;
        wake_writer();
        writer_.join();  // first, since its last report switches the force off and needs the port
        reader_.join();
    }

    // ---- The servo's side ----

    DeviceCaps caps() const noexcept override { return caps_; }
    ReadResult read(DeviceState& state) noexcept override
    {
        const uint64_t connection = connection_;
        if (connection == 0) return ReadResult::lost;
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
        commands_.publish({force_n, sequence});
        wake_writer();
        return connection_ != 0;
    }

private:
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

    DeviceCaps ask_limits(HidPort& port) const
    {
        if (!profile_.feature) return profile_.limits;
        std::array<uint8_t, 1 + MAX_REPORT_BYTES> report{};
        const int size = port.read_feature(profile_.feature->id, report);
        if (size <= 0) return profile_.limits;
        // hidapi puts the id first even if reports are unnumbered.
        const std::span<const uint8_t> bytes(report.data(), size_t(size));
        return decode_feature(profile_, profile_.feature->id == 0 ? bytes.subspan(1) : bytes);
    }

    // ---- The reader's thread ----

    std::shared_ptr<HidPort> port()
    {
        const std::lock_guard lock(port_mutex_);
        return port_;
    }
    /// A write in progress keeps the old port alive until it is done.
    void set_port(std::shared_ptr<HidPort> port)
    {
        const std::lock_guard lock(port_mutex_);
        port_ = std::move(port);
        write_failed_ = false;
    }
    /// Does nothing if the reader has dropped that port meanwhile.
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
                if (!is_running_) return;  // the writer still needs the port, for its last report
                connection_ = 0;
                set_port(nullptr);
                continue;
            }
            const SteadyClock::time_point next_try = SteadyClock::now() + REOPEN_EVERY;
            while (is_running_ && SteadyClock::now() < next_try)
                std::this_thread::sleep_for(milliseconds(READ_TIMEOUT_MS));
            if (!is_running_) return;
            if (std::unique_ptr<HidPort> found = reopen_()) {
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
                else
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
        // An unverified device gets no bytes at all: nobody knows what they would do.
        if (!profile_.verified || !profile_.output || write_failed_) return;
        const std::shared_ptr<HidPort> open = port();
        if (open && !open->write(encode(profile_, command.force_n, command.sequence, enabled).span()))
            report_failed_write(open);
    }

    const HidProfile profile_;
    const HidOpener reopen_;
    DeviceCaps caps_;
    bool may_force_ = false;

    std::mutex port_mutex_;  ///< shared by reader and writer; the servo never takes it
    std::shared_ptr<HidPort> port_;
    std::atomic<uint64_t> connection_;  ///< 0: none
    std::atomic<bool> is_running_{true}, write_failed_{false};
    std::atomic<uint32_t> malformed_{0}, wake_{0};
    uint32_t malformed_seen_ = 0;  ///< used by the servo only

    Latest<Reading> readings_;
    Latest<Command> commands_;
    std::thread reader_, writer_;
};

}  // namespace

std::unique_ptr<HapticDevice> make_hid_link(const HidProfile& profile, std::unique_ptr<HidPort> port, HidOpener reopen,
                                            const HidLinkOptions& options)
{
    return std::make_unique<HidLink>(profile, std::move(port), std::move(reopen), options);
}

}  // namespace shvr

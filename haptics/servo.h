#pragma once
// The servo reads the device, finds the proxy and writes the force, a thousand times a second, on its own thread. It
// shares only latest values with the rest of the program, and never locks, allocates, logs or throws.
//
//   application --Latest<ForceSettings>--> servo --Latest<ServoState>--> application
//   relevance mirror --Latest<RelevancePatch>--> servo --Latest<ProbePlace>--> relevance mirror
//
// The application's thread calls everything here, except that one other thread may use relevance() and place(). The
// servo owns the device.

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <thread>

#include "engine/base/latest.h"
#include "haptics/force.h"

namespace shvr {

/// The servo's clock and sleep, which tests replace.
class Pacing {
public:
    virtual ~Pacing() = default;
    virtual uint64_t now_ns() noexcept = 0;
    /// Sleeps until `deadline_ns`.
    virtual void wait_until(uint64_t deadline_ns) noexcept = 0;
};
/// Returns the real clock: CLOCK_MONOTONIC, absolute sleeps.
std::unique_ptr<Pacing> real_pacing();

/// Counts durations by powers of two: bin 0 below 1 us, bin i from 2^(i-1) to 2^i us; the last bin has no upper end.
struct TimeHistogram {
    static constexpr size_t BINS = 24;
    std::array<uint64_t, BINS> counts{};
    uint64_t worst_ns = 0;
    void add(uint64_t nanoseconds) noexcept;
    uint64_t total() const noexcept;
    /// Returns the upper end, in microseconds, of the bin where the cumulative share reaches `share`; 0 without values.
    double quantile_us(double share) const noexcept;
};

/// The probe's position and motion, for the code that mirrors relevance around it.
struct ProbePlace {
    glm::dvec3 point{0.0};     ///< physical
    glm::dvec3 velocity{0.0};  ///< physical units per second
    bool is_known = false;     ///< the device is present, and the servo has settings
};

/// The servo's state, as published to the application.
struct ServoState {
    uint64_t time_ns = 0;
    uint64_t ticks = 0;
    uint64_t late_ticks = 0;  ///< started more than one period late
    DeviceState device;
    ForceStep step;
    DeviceCaps caps;
    TimeHistogram lateness;          ///< how late ticks started
    TimeHistogram duration;          ///< work time of each tick
    TimeHistogram relevance_age;     ///< age of the patch in use, over ticks with assistance
    uint64_t relevance_time_ns = 0;  ///< time of that patch; 0: none yet
};

class Servo {
public:
    struct Options {
        uint32_t rate_hz = 1000;
        bool realtime = true;  ///< SCHED_FIFO if the system allows it; see is_realtime()
    };
    Servo(std::unique_ptr<HapticDevice> device, std::unique_ptr<Pacing> pacing, const Options& options);
    /// Writes a zero force and joins the thread.
    ~Servo();
    Servo(const Servo&) = delete;
    Servo& operator=(const Servo&) = delete;

    Latest<ForceSettings>& settings() { return settings_; }
    Latest<RelevancePatch>& relevance() { return relevance_; }
    Latest<ServoState>& state() { return state_; }
    /// Returns the probe's place, for one reading thread; another thread may read state().
    Latest<ProbePlace>& place() { return place_; }
    /// Returns whether the system granted SCHED_FIFO; if not, only the timer slack is reduced.
    bool is_realtime() const { return is_realtime_; }
    /// Returns whether all memory needed in a tick could be locked (kept_memory.h). Valid after the first tick. If
    /// false, the first tick has loaded that memory, but the system may page it out when the program has run for long.
    bool keeps_memory() const { return keeps_memory_; }

private:
    void run() noexcept;
    std::unique_ptr<HapticDevice> device_;
    std::unique_ptr<Pacing> pacing_;
    Options options_;
    std::unique_ptr<GrowthMemory> growth_;
    Latest<ForceSettings> settings_;
    Latest<RelevancePatch> relevance_;
    Latest<ServoState> state_;
    Latest<ProbePlace> place_;
    std::atomic<bool> running_{true};
    bool is_realtime_ = false;
    std::atomic<bool> keeps_memory_{false};
    std::thread thread_;
};

}  // namespace shvr

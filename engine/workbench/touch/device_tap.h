#pragma once
// Stands between the servo and its device, on the servo's thread: holds the probe in a plane, passes settings on at
// the beginning of a tick, and records ticks for plots and recordings.
//
//   main thread --orders()--> TapPacing --> Servo::settings()        Servo <--> DeviceTap <--> device
//   main thread <--take()---- ring of ticks <------ DeviceTap        main thread <--state()-- DeviceTap
//
// Settings go through the tap, so that a recording knows in which tick they took effect. For relevance, the tap records
// per tick the sequence that the servo used. On the servo's thread nothing here locks, allocates, logs or throws; a
// recording whose ticks are not fetched in time ends.

#include <array>
#include <atomic>
#include <memory>
#include <vector>

#include "engine/workbench/touch/relevance_log.h"
#include "haptics/replay/trace.h"
#include "haptics/servo.h"

namespace shvr::ui {

/// A plane, in the device's frame, that holds the probe: removes the force along its normal, unless `is_on` is false.
struct PlaneHold {
    bool is_on = false;
    glm::dvec3 normal{0.0, 0.0, 1.0}, point_m{0.0};
    uint32_t count = 0;  ///< number of planes so far; if it changes, the servo expects the probe to jump
    bool operator==(const PlaneHold&) const = default;
};

struct TapOrder {
    TraceSettings settings;
    PlaneHold plane;
    uint32_t recording = 0;  ///< number of the recording under way; 0: none
    bool operator==(const TapOrder&) const = default;
};

/// Forces of the last seconds, and values that ServoState does not contain.
struct TapState {
    static constexpr size_t BARS = 250;
    static constexpr uint32_t TICKS_A_BAR = 20;
    std::array<float, BARS> force_n{};  ///< maximum force of each TICKS_A_BAR ticks; the oldest is at `bars` % BARS
    uint64_t bars = 0;
    double heat = 0.0;         ///< motor heat as a share of the continuous limit, by the model in haptics/safety.h
    uint64_t lost_states = 0;  ///< gaps in the device's sequence numbers
};

struct RecordedTick {
    TraceTick tick;
    bool has_settings = false;
    TraceSettings settings;
    DeviceCaps caps;
    uint64_t relevance = 0;  ///< sequence number of the relevance in use; 0: none
    uint32_t recording = 0;
};

class TapLink {
public:
    /// `recording`: number of a recording that starts at the first tick; 0: no recording.
    explicit TapLink(uint32_t recording = 0) : ring_(RING), recording_(recording)
    {
        if (recording != 0) relevance_log_.begin();
    }
    // Main thread
    Latest<TapOrder>& orders() { return orders_; }
    Latest<TapState>& state() { return state_; }
    /// Connects the settings, which the servo receives, and the relevance, which the servo uses.
    void connect(Latest<ForceSettings>& settings, const Latest<RelevancePatch>& relevance)
    {
        relevance_.store(&relevance, std::memory_order_release);
        settings_.store(&settings, std::memory_order_release);
    }
    RelevanceLog& relevance_log() { return relevance_log_; }
    bool take(RecordedTick& tick);
    /// Returns whether ticks were lost because the main thread did not fetch them in time.
    bool has_overrun() const { return has_overrun_.load(std::memory_order_relaxed); }

    // The servo's thread
    void begin_tick() noexcept;
    void note_now(uint64_t now_ns) noexcept;
    void note_caps(const DeviceCaps& caps) noexcept { now_.caps = caps; }
    void note_read(ReadResult result, const DeviceState& state) noexcept;
    void note_write(const glm::dvec3& asked_n, const glm::dvec3& force_n, bool was_written,
                    const DeviceCaps& caps) noexcept;
    const PlaneHold& plane() const noexcept { return orders_.value().plane; }

private:
    static constexpr uint64_t RING = 4096;  ///< capacity in ticks: enough for a window that stalls for four seconds
    void put() noexcept;
    void add_to_plot(double force_n) noexcept;

    Latest<TapOrder> orders_;
    Latest<TapState> state_;
    std::atomic<Latest<ForceSettings>*> settings_{nullptr};
    std::atomic<const Latest<RelevancePatch>*> relevance_{nullptr};
    RelevanceLog relevance_log_;
    std::vector<RecordedTick> ring_;
    alignas(64) std::atomic<uint64_t> written_{0};
    alignas(64) std::atomic<uint64_t> fetched_{0};
    std::atomic<bool> has_overrun_{false};

    // The servo's thread alone
    RecordedTick now_;
    TapState plot_;
    HeatMemory heat_;
    float bar_ = 0.0f;
    uint32_t in_bar_ = 0, last_sequence_ = 0, recording_ = 0;
    uint64_t last_ns_ = 0;
    bool is_new_tick_ = false, has_new_settings_ = false, has_sequence_ = false, was_written_ = true;
};

class TapPacing : public Pacing {
public:
    TapPacing(std::unique_ptr<Pacing> pacing, std::shared_ptr<TapLink> link)
        : pacing_(std::move(pacing)), link_(std::move(link))
    {}
    uint64_t now_ns() noexcept override
    {
        const uint64_t now = pacing_->now_ns();
        link_->note_now(now);
        return now;
    }
    void wait_until(uint64_t deadline_ns) noexcept override
    {
        pacing_->wait_until(deadline_ns);
        link_->begin_tick();
    }

private:
    std::unique_ptr<Pacing> pacing_;
    std::shared_ptr<TapLink> link_;
};

class DeviceTap : public HapticDevice {
public:
    DeviceTap(std::shared_ptr<HapticDevice> device, std::shared_ptr<TapLink> link)
        : device_(std::move(device)), link_(std::move(link))
    {}
    DeviceCaps caps() const noexcept override
    {
        const DeviceCaps caps = device_->caps();
        link_->note_caps(caps);
        return caps;
    }
    ReadResult read(DeviceState& state) noexcept override;
    bool write(const glm::dvec3& force_n, uint32_t sequence) noexcept override;
    const char* trouble() const noexcept override { return device_->trouble(); }

private:
    std::shared_ptr<HapticDevice> device_;
    std::shared_ptr<TapLink> link_;
    DeviceState raw_;
};

/// A servo and its device, with the tap between them. Main thread only.
struct TappedServo {
    explicit TappedServo(std::shared_ptr<HapticDevice> with, std::unique_ptr<Pacing> pacing = real_pacing(),
                         uint32_t recording = 0);
    /// Returns the relevance to fill in before publish_relevance(). One thread, which may be any, must call both.
    RelevancePatch& relevance() { return servo.relevance().writing(); }
    void publish_relevance();
    std::shared_ptr<HapticDevice> device;
    std::shared_ptr<TapLink> link;
    Servo servo;
};

}  // namespace shvr::ui

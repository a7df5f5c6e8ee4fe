#pragma once
// Collects the records of a device tap into a stylus recording (haptics/replay). Main thread.

#include <filesystem>
#include <optional>
#include <string>

#include "engine/workbench/touch/device_tap.h"

namespace shvr::ui {

class StylusRecorder {
public:
    /// `unit`: unit of the volume's lengths. `number`: number of the recording, above 0, as in TapOrder::recording.
    StylusRecorder(std::filesystem::path path, std::string unit, uint32_t number);
    /// Continues with the tap of another device and servo. Call this after fetching the old tap's remaining ticks.
    void swap_device();
    /// Fetches new ticks.
    void advance(TapLink& link);
    const std::filesystem::path& path() const { return path_; }
    uint32_t number() const { return number_; }
    double seconds() const { return double(trace_.ticks.size()) / trace_.rate_hz; }
    /// Returns why the recording has to end; empty if it can continue.
    const std::string& end() const { return end_; }
    /// Returns the recording. Fails if it has no tick.
    Trace take();

private:
    void add_relevance(RelevanceLog& log);
    void add_caps();
    std::filesystem::path path_;
    uint32_t number_ = 0;
    Trace trace_;
    std::string end_;
    uint64_t relevance_ = 0;  ///< sequence of the trace's last relevance
    RecordedTick tick_;
};

}  // namespace shvr::ui

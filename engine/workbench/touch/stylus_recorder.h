#pragma once
// Gathers what the tap of a device noted into a stylus trace (haptics/replay). Main thread.

#include <filesystem>
#include <optional>
#include <string>

#include "engine/workbench/touch/device_tap.h"

namespace shvr::ui {

class StylusRecorder {
public:
    /// `unit`: of the volume's lengths. `number`: of the recording, above 0, as orders to the tap have it.
    StylusRecorder(std::filesystem::path path, std::string unit, uint32_t number);
    /// From now on another device answers another servo, whose tap is fetched from; the former's was fetched before.
    void swap_device();
    /// Fetches what is new.
    void advance(TapLink& link);
    const std::filesystem::path& path() const { return path_; }
    uint32_t number() const { return number_; }
    double seconds() const { return double(trace_.ticks.size()) / trace_.rate_hz; }
    /// Why it cannot go on; empty: it can.
    const std::string& end() const { return end_; }
    /// The trace. Fails where there is no tick.
    Trace take();

private:
    void add_relevance(RelevanceLog& log);
    void add_caps();
    std::filesystem::path path_;
    uint32_t number_ = 0;
    Trace trace_;
    std::string end_;
    uint64_t relevance_ = 0;  ///< sequence of the last one that the trace has
    RecordedTick tick_;
};

}  // namespace shvr::ui

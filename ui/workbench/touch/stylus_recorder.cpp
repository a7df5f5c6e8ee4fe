#include "ui/workbench/touch/stylus_recorder.h"

#include "engine/base/error.h"

namespace shvr::ui {

StylusRecorder::StylusRecorder(std::filesystem::path path, std::string unit, uint32_t number)
    : path_(std::move(path)), number_(number)
{
    trace_.unit = std::move(unit);
}

void StylusRecorder::advance(TapLink& link)
{
    if (!end_.empty()) return;
    while (link.take(tick_)) {
        if (tick_.recording != number_) continue;
        if (tick_.has_settings) {
            tick_.settings.from_tick = trace_.ticks.size();
            trace_.settings.push_back(tick_.settings);
        }
        trace_.ticks.push_back(tick_.tick);
        if (trace_.ticks.size() < MAX_TRACE_TICKS) continue;
        end_ = "the recording is as long as a recording can be";
        return;
    }
    if (link.has_overrun()) end_ = "the window hung for seconds, and what happened then was not recorded";
}

Trace StylusRecorder::take(const DeviceCaps& caps)
{
    if (trace_.ticks.empty()) fail("the recording is empty; expected a device that moves the probe");
    trace_.caps = caps;
    return std::move(trace_);
}

}  // namespace shvr::ui

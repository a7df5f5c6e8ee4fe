#include "engine/workbench/touch/stylus_recorder.h"

#include "engine/base/error.h"

namespace shvr::ui {

StylusRecorder::StylusRecorder(std::filesystem::path path, std::string unit, uint32_t number)
    : path_(std::move(path)), number_(number)
{
    trace_.unit = std::move(unit);
    trace_.holds_relevance = true;
    trace_.feels_seen = true;
    trace_.settings.emplace_back();  // the defaults, which a servo uses until it receives settings
}

void StylusRecorder::advance(TapLink& link)
{
    if (!end_.empty()) return;
    while (link.take(tick_)) {
        if (tick_.recording != number_) continue;
        add_caps();
        add_relevance(link.relevance_log());
        if (!end_.empty()) return;
        if (tick_.has_settings) {
            tick_.settings.from_tick = trace_.ticks.size();
            if (trace_.ticks.empty()) trace_.settings.clear();
            trace_.settings.push_back(tick_.settings);
        }
        trace_.ticks.push_back(tick_.tick);
        if (trace_.ticks.size() < MAX_TRACE_TICKS) continue;
        end_ = "the recording is as long as a recording can be";
        return;
    }
    if (link.has_overrun()) end_ = "the window hung for seconds, and what happened then was not recorded";
}

void StylusRecorder::swap_device()
{
    if (trace_.ticks.empty()) return;
    const size_t tick = trace_.ticks.size();
    if (trace_.swaps.empty() || trace_.swaps.back() != tick) trace_.swaps.push_back(tick);
    trace_.settings.emplace_back().from_tick = tick;  // the new servo uses defaults until it receives settings
    relevance_ = 0;
}

/// Adds the relevance in use, and also entries before it that the servo skipped, since later entries refer to them.
void StylusRecorder::add_relevance(RelevanceLog& log)
{
    if (tick_.relevance == relevance_) return;
    while (std::optional<TraceRelevance> noted = log.take(tick_.relevance)) {
        relevance_ = noted->sequence;
        noted->from_tick = trace_.ticks.size();
        trace_.relevance.push_back(std::move(*noted));
    }
    if (relevance_ != tick_.relevance) end_ = "what could be felt changed too often to be recorded";
}

void StylusRecorder::add_caps()
{
    const DeviceCaps& known = trace_.later_caps.empty() ? trace_.caps : trace_.later_caps.back().caps;
    if (tick_.caps == known) return;
    if (trace_.ticks.empty())
        trace_.caps = tick_.caps;
    else
        trace_.later_caps.push_back({tick_.caps, trace_.ticks.size()});
}

Trace StylusRecorder::take()
{
    const size_t ticks = trace_.ticks.size();  // drops swaps and settings of devices that had no tick
    std::erase_if(trace_.swaps, [&](size_t from) { return from >= ticks; });
    std::erase_if(trace_.settings, [&](const TraceSettings& settings) { return settings.from_tick >= ticks; });
    if (trace_.ticks.empty()) fail("the recording is empty; expected a device that moves the probe");
    return std::move(trace_);
}

}  // namespace shvr::ui

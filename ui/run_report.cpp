#include "ui/run_report.h"

#include <algorithm>
#include <utility>

namespace shvr::ui {

namespace {

/// Adds a time, and drops the oldest times, since a day's work has millions of frames.
void note(std::vector<double>& all, double value)
{
    if (all.size() == 2 * RunReport::KEPT) all.erase(all.begin(), all.begin() + std::ptrdiff_t(RunReport::KEPT));
    all.push_back(value);
}

}  // namespace

void RunReport::opened(double time_s)
{
    opened_s_ = time_s;
    report_.first_picture_ms = report_.sharp_picture_ms = std::nullopt;
}

void RunReport::presented(const Frame& frame)
{
    if (was_moving_ && frame.moves) note(report_.interval_ms, (frame.begun_s - last_begun_s_) * 1e3);
    was_moving_ = frame.moves;
    last_begun_s_ = frame.begun_s;
    ++report_.frames;
    presented_.push_back({frame, std::exchange(unanswered_s_, {})});
}

void RunReport::done(uint64_t number, double time_s)
{
    std::erase_if(presented_, [&](const Presented& presented) {
        const Frame& frame = presented.frame;
        if (frame.number > number) return false;
        note(report_.frame_ms, (time_s - frame.begun_s) * 1e3);
        note(frame.shows_sharp_picture ? report_.own_idle_ms : report_.own_busy_ms,
             (time_s - frame.begun_s - frame.waited_s) * 1e3);
        const double since_open_ms = (time_s - opened_s_) * 1e3;
        if (frame.shows_picture && !report_.first_picture_ms) report_.first_picture_ms = since_open_ms;
        if (frame.shows_sharp_picture && !report_.sharp_picture_ms) report_.sharp_picture_ms = since_open_ms;
        for (const double asked_s : presented.asked_s) note(report_.input_ms, (time_s - asked_s) * 1e3);
        return true;
    });
}

double RunReport::recent_frame_ms() const
{
    constexpr size_t RECENT = 31;
    const std::vector<double>& all = report_.frame_ms;
    std::vector<double> recent(all.end() - std::ptrdiff_t(std::min(all.size(), RECENT)), all.end());
    if (recent.empty()) return 0.0;
    const auto middle = recent.begin() + std::ptrdiff_t(recent.size() / 2);
    std::ranges::nth_element(recent, middle);
    return *middle;
}

}  // namespace shvr::ui

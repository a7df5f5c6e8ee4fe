#include "engine/base/progress.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace shvr {
namespace {

constexpr double SILENT_SECONDS = 1.0;
/// Minimum interval between two lines; on a terminal, between two changes of the line.
constexpr double LINE_SECONDS = 10.0, REWRITE_SECONDS = 0.1;
constexpr const char* CLEARED = "\r\x1b[K";

}  // namespace

std::string duration_text(double seconds)
{
    const auto whole = int64_t(std::ceil(std::clamp(seconds, 0.0, 3.6e9)));
    if (whole < 60) return sentence(whole, " s");
    if (whole < 3600) return sentence(whole / 60, " min ", whole % 60, " s");
    return sentence(whole / 3600, " h ", whole / 60 % 60, " min");
}

ProgressLine::ProgressLine(Place place) : place_(std::move(place)), started_(place_.seconds()), begun_(started_) {}

void ProgressLine::begin(std::string what)
{
    what_ = std::move(what);
    begun_ = place_.seconds();
    first_fraction_ = -1.0;
}

void ProgressLine::show(double fraction, const std::string& detail, double seconds_left)
{
    const double now = place_.seconds();
    if (first_fraction_ < 0.0) first_fraction_ = fraction;
    const bool is_known = fraction >= 0.0;
    if (now - started_ < SILENT_SECONDS) return;
    if (has_told_ && now - told_ < (place_.is_terminal ? REWRITE_SECONDS : LINE_SECONDS)) return;
    has_told_ = true;
    told_ = now;
    std::string line =
        what_ + ": " +
        (is_known ? sentence(int(100.0 * std::min(fraction, 1.0)), " %") : duration_text(now - begun_) + " so far");
    if (!detail.empty()) line += ", " + detail;
    const double gone = is_known ? fraction - first_fraction_ : 0.0;
    if (seconds_left < 0.0 && gone > 0.0) seconds_left = (1.0 - fraction) / gone * (now - begun_);
    if (seconds_left >= 0.0) line += ", " + duration_text(seconds_left) + " left";
    place_.write(place_.is_terminal ? CLEARED + line : line + "\n");
    is_shown_ = place_.is_terminal;
}

void ProgressLine::clear()
{
    if (std::exchange(is_shown_, false)) place_.write(CLEARED);
}

}  // namespace shvr

#include "tools/cli/profile/chart.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iomanip>
#include <iterator>

#include "engine/base/error.h"
#include "engine/base/image.h"
#include "engine/pages/html.h"

namespace shvr::cli {

namespace {

constexpr const char* PASS_COLORS[] = {"#0072b2", "#e69f00", "#009e73", "#d55e00", "#cc79a7", "#56b4e9", "#8a7d18"};
constexpr double HEIGHT_OF_LINE = 70.0, WIDTH_OF_LETTER = 7.0;

/// Returns the distance between ticks: 1, 2 or 5 times a power of ten, so that about ten ticks fit into `length`.
double tick_of(double length)
{
    const double least = length / 10.0, power = std::pow(10.0, std::floor(std::log10(least)));
    for (const double step : {1.0, 2.0, 5.0})
        if (step * power >= least) return step * power;
    return 10.0 * power;
}

/// Returns black or white, whichever has more contrast on "#rrggbb" (WCAG 2: black from a luminance of 0.179 on).
const char* ink_on(const std::string& color)
{
    double luminance = 0.0;
    constexpr double WEIGHTS[] = {0.2126, 0.7152, 0.0722};
    for (size_t channel = 0; channel < 3; ++channel)
        luminance += WEIGHTS[channel] * srgb_decode(std::stoi(color.substr(1 + 2 * channel, 2), nullptr, 16) / 255.0);
    return luminance < 0.179 ? "#fff" : "#000";
}

}  // namespace

std::string PassColors::of(const std::string& name) const
{
    const auto place = size_t(std::ranges::find(names_, name) - names_.begin());
    return PASS_COLORS[place % std::size(PASS_COLORS)];
}

std::string grouped_text(int64_t number)
{
    std::string digits = std::to_string(number < 0 ? -number : number);
    for (auto at = int64_t(digits.size()) - 3; at > 0; at -= 3) digits.insert(size_t(at), "\u202f");
    return number < 0 ? "-" + digits : digits;
}

std::string bytes_text(uint64_t bytes)
{
    if (bytes < 1024) return sentence(bytes, " bytes");
    const bool is_large = bytes >= uint64_t{1} << 20;
    return sentence(std::fixed, std::setprecision(1), double(bytes) / double(is_large ? 1 << 20 : 1 << 10),
                    is_large ? " MiB" : " KiB");
}

Chart::Chart(double left, double end_ms)
    : left_(left), per_ms_((WIDTH - left - 12.0) / std::max(end_ms, 1e-6)), end_ms_(std::max(end_ms, 1e-6))
{}

void Chart::begin_row(const std::string& name)
{
    row_y_ = bottom_;
    bottom_ += ROW;
    marks_ += sentence("<text x=\"4\" y=\"", row_y_ + 14.0, "\">", report::escaped(name), "</text>\n");
}

void Chart::bar(double begin_ms, double length_ms, const std::string& color, const std::string& tooltip,
                const std::string& on_it, size_t lane)
{
    const double y = row_y_ + double(lane) * ROW, width = std::max(length_ms * per_ms_, 0.7);
    bottom_ = std::max(bottom_, y + ROW);
    marks_ += sentence("<rect x=\"", x(begin_ms), "\" y=\"", y, "\" width=\"", width, "\" height=\"", ROW - 4.0,
                       "\" fill=\"", color, "\"><title>", report::escaped(tooltip), "</title></rect>\n");
    if (!on_it.empty() && width > WIDTH_OF_LETTER * double(on_it.size()) + 8.0)
        marks_ += sentence("<text class=\"on\" style=\"fill:", ink_on(color), "\" x=\"", x(begin_ms) + 4.0, "\" y=\"",
                           y + 13.0, "\">", report::escaped(on_it), "</text>\n");
}

void Chart::line(const std::string& name, const std::vector<std::pair<double, double>>& values, const std::string& most)
{
    double highest = 0.0;
    for (const auto& [ms, value] : values) highest = std::max(highest, value);
    const double top = bottom_ + 8.0, base = top + HEIGHT_OF_LINE;
    const auto y = [&](double value) { return highest > 0.0 ? base - HEIGHT_OF_LINE * value / highest : base; };
    std::string points;
    for (size_t i = 0; i < values.size(); ++i) {
        if (i == 0) points += sentence(x(0.0), ",", y(values[0].second), " ");
        if (i > 0) points += sentence(x(values[i].first), ",", y(values[i - 1].second), " ");
        points += sentence(x(values[i].first), ",", y(values[i].second), " ");
    }
    marks_ += sentence("<line x1=\"", left_, "\" y1=\"", base, "\" x2=\"", WIDTH - 12.0, "\" y2=\"", base,
                       "\"/>\n<polyline fill=\"none\" stroke=\"#0072b2\" stroke-width=\"2\" points=\"", points,
                       "\"><title>", report::escaped(name), "</title></polyline>\n<text x=\"4\" y=\"", top + 8.0, "\">",
                       report::escaped(most), "</text>\n<text x=\"4\" y=\"", base - 0.5 * HEIGHT_OF_LINE + 4.0, "\">",
                       report::escaped(name), "</text>\n<text x=\"4\" y=\"", base, "\">0</text>\n");
    bottom_ = base + 6.0;
}

std::string Chart::svg(const std::string& unit, double least_tick) const
{
    const double axis = bottom_ + 4.0, tick = std::max(tick_of(end_ms_), least_tick);
    std::string ticks;
    for (int i = 0; double(i) * tick <= end_ms_ * 1.0001; ++i) {
        const double at = x(double(i) * tick);
        ticks += sentence("<line x1=\"", at, "\" y1=\"2\" x2=\"", at, "\" y2=\"", axis,
                          "\"/>\n<text text-anchor=\"middle\" x=\"", at, "\" y=\"", axis + 14.0, "\">",
                          double(i) * tick, i == 0 && !unit.empty() ? " " + unit : "", "</text>\n");
    }
    return sentence("<svg class=\"chart\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 ", WIDTH, " ", axis + 20.0,
                    "\" width=\"", WIDTH, "\">\n", ticks, marks_, "</svg>\n");
}

}  // namespace shvr::cli

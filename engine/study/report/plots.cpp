#include "engine/study/report/plots.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "engine/base/error.h"
#include "engine/pages/html.h"

namespace shvr {

namespace {

constexpr double WIDTH = 920.0, LEFT = 350.0, RIGHT = 20.0, TOP = 46.0, ROW = 26.0, BOTTOM = 48.0;

std::string fixed_digits(double value, int decimals)
{
    char digits[400];
    const auto end = std::to_chars(std::begin(digits), std::end(digits), value, std::chars_format::fixed, decimals);
    return std::string(digits, end.ptr);
}

struct Scale {
    double low = 0.0, high = 1.0;
    double at(double value) const { return LEFT + (WIDTH - LEFT - RIGHT) * (value - low) / (high - low); }
};

std::string px(double value)
{
    return fixed_digits(value, 1);
}

std::string text_at(double x, double y, const char* anchor, const std::string& words, const char* look = "label")
{
    return sentence("<text class=\"", look, "\" x=\"", px(x), "\" y=\"", px(y), "\" text-anchor=\"", anchor, "\">",
                    report::escaped(words), "</text>\n");
}

std::string line_at(double x0, double y0, double x1, double y1, const char* look)
{
    return sentence("<line class=\"", look, "\" x1=\"", px(x0), "\" y1=\"", px(y0), "\" x2=\"", px(x1), "\" y2=\"",
                    px(y1), "\"/>\n");
}

/// Returns the points of one row, each with a vertical offset by its index, so that equal values do not overlap.
std::string points_of(const PlotLine& line, const Scale& scale, double middle)
{
    std::string markup;
    for (size_t i = 0; i < line.values.size(); ++i)
        markup += sentence("<circle class=\"point\" cx=\"", px(scale.at(line.values[i])), "\" cy=\"",
                           px(middle + 1.6 * (double(i % 5) - 2.0)), "\" r=\"2\"/>\n");
    return markup;
}

std::string row_of(const PlotLine& line, const Scale& scale, double middle)
{
    const Summary summary = summary_of(line.values);
    std::string markup = text_at(LEFT - 10.0, middle + 4.0, "end", line.label);
    if (summary.count == 0) return markup + text_at(LEFT + 6.0, middle + 4.0, "start", "no value", "faint");
    const double box = scale.at(summary.lower_quartile);
    markup += sentence("<g><title>", report::escaped(line.label), ": mean ", short_digits(summary.mean), " [",
                       short_digits(summary.interval.low), ", ", short_digits(summary.interval.high), "], median ",
                       short_digits(summary.median), ", ", summary.count, " values</title>\n");
    markup += sentence("<rect class=\"box\" x=\"", px(box), "\" y=\"", px(middle - 8.0), "\" width=\"",
                       px(std::max(scale.at(summary.upper_quartile) - box, 0.5)), "\" height=\"16\"/>\n");
    markup += points_of(line, scale, middle);
    markup += line_at(scale.at(summary.median), middle - 8.0, scale.at(summary.median), middle + 8.0, "median");
    const char* const tone = line.tone > 0 ? "mean good" : line.tone < 0 ? "mean bad" : "mean";
    if (summary.count > 1)
        markup += line_at(scale.at(summary.interval.low), middle, scale.at(summary.interval.high), middle, tone);
    const double x = scale.at(summary.mean);
    markup += sentence("<path class=\"", tone, "\" d=\"M", px(x), ' ', px(middle - 6.0), "L", px(x + 6.0), ' ',
                       px(middle), "L", px(x), ' ', px(middle + 6.0), "L", px(x - 6.0), ' ', px(middle), "Z\"/>\n");
    return markup + "</g>\n";
}

Scale scale_of(const IntervalPlot& plot, std::vector<double>& ticks)
{
    double low = plot.reference.value_or(std::numeric_limits<double>::infinity());
    double high = plot.reference.value_or(-std::numeric_limits<double>::infinity());
    for (const PlotLine& line : plot.lines)
        for (const double value : line.values) {
            low = std::min(low, value);
            high = std::max(high, value);
        }
    if (!(low <= high)) low = 0.0, high = 1.0;
    ticks = ticks_of(low, high);
    return {std::min(low, ticks.front()), std::max(high, ticks.back())};
}

}  // namespace

std::string short_digits(double value)
{
    if (std::isnan(value)) return "-";
    const double size = std::abs(value);
    if (value == std::floor(value) && size < 1e6) return fixed_digits(value + 0.0, 0);  // + 0.0: no "-0"
    std::string digits = fixed_digits(value, size >= 100.0 ? 0 : size >= 10.0 ? 1 : size >= 1.0 ? 2 : 3);
    const bool is_zero = digits.find_first_not_of("-0.") == digits.npos;
    return is_zero ? "0" : digits;
}

std::vector<double> ticks_of(double low, double high, int most)
{
    const double span = high > low ? high - low : std::max(std::abs(high), 1.0) * 1e-3;
    double step = 1.0;
    while (step < span) step *= 10.0;
    while (step >= span) step /= 10.0;
    step /= 10.0;
    // 10 to 100 steps cover the span, so with factor 100 one or two suffice: the loop always finds a factor.
    for (const double factor : {1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0}) {
        const double first = std::floor(low / (step * factor)), last = std::ceil(high / (step * factor));
        if (last - first > most - 1 && factor < 100.0) continue;
        std::vector<double> ticks;
        for (double tick = first; tick <= std::max(last, first + 1.0); tick += 1.0)
            ticks.push_back(tick * step * factor);
        return ticks;
    }
    return {low, high};
}

std::string svg_of(const IntervalPlot& plot)
{
    std::vector<double> ticks;
    const Scale scale = scale_of(plot, ticks);
    const double bottom = TOP + ROW * double(plot.lines.size());
    std::string svg = sentence("<svg class=\"plot\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 ", px(WIDTH),
                               ' ', px(bottom + BOTTOM), "\" width=\"", px(WIDTH), "\" role=\"img\" aria-label=\"",
                               report::escaped(plot.title), "\">\n");
    svg += text_at(LEFT, 16.0, "start", plot.title, "title");
    for (const double tick : ticks) {
        svg += line_at(scale.at(tick), TOP - 6.0, scale.at(tick), bottom, "grid");
        svg += text_at(scale.at(tick), bottom + 16.0, "middle", short_digits(tick));
    }
    if (plot.reference) {
        svg += line_at(scale.at(*plot.reference), TOP - 6.0, scale.at(*plot.reference), bottom, "reference");
        const bool is_right = scale.at(*plot.reference) > 0.5 * (LEFT + WIDTH);
        svg += text_at(scale.at(*plot.reference) + (is_right ? -4.0 : 4.0), TOP - 8.0, is_right ? "end" : "start",
                       plot.reference_label, "faint");
    }
    for (size_t i = 0; i < plot.lines.size(); ++i) svg += row_of(plot.lines[i], scale, TOP + ROW * (double(i) + 0.5));
    return svg + text_at(0.5 * (LEFT + WIDTH), bottom + 36.0, "middle", plot.axis) + "</svg>\n";
}

}  // namespace shvr

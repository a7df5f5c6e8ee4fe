#pragma once
// Draws bars along an axis of milliseconds as SVG for a page, which defines the colours of text and lines (html.cpp).

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace shvr::cli {

/// A colour per pass, the same in every chart. Up to seven passes get seven colours, distinguishable with any colour
/// vision (Okabe and Ito 2008). With more passes, at least consecutive passes differ.
class PassColors {
public:
    /// `names`: unique names of passes, in the order in which the passes first ran.
    explicit PassColors(std::vector<std::string> names) : names_(std::move(names)) {}
    std::string of(const std::string& name) const;

private:
    std::vector<std::string> names_;
};

/// Groups digits with narrow spaces: 1234567 -> "1 234 567".
std::string grouped_text(int64_t number);
/// "3.4 MiB"
std::string bytes_text(uint64_t bytes);

/// CSS that a page with charts must contain.
inline constexpr const char* CHART_STYLE = R"(.chart{font:12px sans-serif;border:1px solid var(--line)}
.chart text{fill:var(--ink)}.chart text.on{pointer-events:none}.chart line{stroke:var(--line)}
.chart rect:hover{stroke:var(--ink);stroke-width:2}
.swatch{display:inline-block;width:.8em;height:.8em;margin-right:.5em})";

class Chart {
public:
    static constexpr double WIDTH = 1400.0, ROW = 22.0;

    /// `left`: space for the names of rows.
    Chart(double left, double end_ms);
    /// Starts a row below all previous ones.
    void begin_row(const std::string& name);
    /// Adds a bar to the last row, in lane `lane` (0 is the topmost). `tooltip` describes the bar; `on_it` is drawn on
    /// the bar if it fits.
    void bar(double begin_ms, double length_ms, const std::string& color, const std::string& tooltip,
             const std::string& on_it = {}, size_t lane = 0);
    /// Adds a step curve between 0 and the maximum: each value holds from its time to the next.
    void line(const std::string& name, const std::vector<std::pair<double, double>>& values, const std::string& most);
    /// Returns the chart as SVG, with an axis whose ticks are at least `least_tick` apart.
    std::string svg(const std::string& unit = "ms", double least_tick = 0.0) const;

private:
    double x(double ms) const { return left_ + ms * per_ms_; }

    double left_, per_ms_, end_ms_;
    double row_y_ = 0.0, bottom_ = 6.0;
    std::string marks_;
};

}  // namespace shvr::cli

#pragma once
// Plots of a study as inline SVG: for each condition its values as points, quartiles as a box, and the mean with its
// interval. The colours are those of the page (engine/pages/html.h), light or dark. Any thread.

#include <optional>
#include <string>
#include <vector>

#include "engine/study/statistics.h"

namespace shvr {

struct PlotLine {
    std::string label;
    std::vector<double> values;
    int tone = 0;  ///< 1: better, -1: worse, 0: neither
};

struct IntervalPlot {
    std::string title, axis;  ///< `axis`: quantity and unit
    std::vector<PlotLine> lines;
    std::optional<double> reference;  ///< value at which a vertical line is drawn, such as 0 or the thesis's mean
    std::string reference_label;
};

std::string svg_of(const IntervalPlot& plot);

/// Returns tick positions: at most `most` - 1 equal steps, of 1, 2 or 5 times a power of ten, that cover both ends.
std::vector<double> ticks_of(double low, double high, int most = 8);

/// Formats with at least three significant digits, at most three decimals, none for whole numbers; NaN as "-".
std::string short_digits(double value);

}  // namespace shvr

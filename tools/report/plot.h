#pragma once
// Log-log scatter plots, as SVG or pixels, drawn by the same code. Families have marks of distinct shapes and colours,
// distinguishable with any colour vision (Okabe and Ito 2008); a line joins the front; labels. Any thread.

#include <string>
#include <vector>

#include "engine/base/image.h"

namespace shvr::report {

struct PlotPoint {
    double x = 1.0, y = 1.0;  ///< values not above 0 are left out
    std::string label;        ///< next to the mark; empty: none
    bool on_front = false;    ///< joined by a line; points off the front are paler, unless they have a label
};

struct PlotSeries {
    std::string name;
    std::vector<PlotPoint> points;
    bool is_joined = false;  ///< a line in the series' colour joins its points, all of which are opaque
    bool is_other = false;   ///< the series with which the others are compared: opaque, in the ink of the axes
};

struct Plot {
    std::string title, x_label, y_label;
    std::vector<PlotSeries> series;  ///< the eighth series has the first one's colour, but another mark
    int width = 720, height = 480;   ///< pixels
};

/// Self-contained: no external style or font.
std::string svg_of(const Plot& plot);
Image8 picture_of(const Plot& plot);

}  // namespace shvr::report

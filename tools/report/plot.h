#pragma once
// Log-log scatter plots with labels, drawn by the same code as SVG or pixels. Series have marks of distinct shapes and
// colours, distinguishable with any colour vision (Okabe and Ito 2008); a line joins the front. Any thread.

#include <string>
#include <vector>

#include "engine/base/image.h"

namespace shvr::report {

struct PlotPoint {
    double x = 1.0, y = 1.0;  ///< points with values that are not above 0 are omitted
    std::string label;        ///< next to the mark; empty: none
    bool on_front = false;    ///< joined by a line; points off the front are paler, unless labelled
};

struct PlotSeries {
    std::string name;
    std::vector<PlotPoint> points;
    bool is_joined = false;  ///< the series' points are joined by a line, and are all opaque
    bool is_other = false;   ///< the series with which the others are compared: opaque, in the axes' colour
};

struct Plot {
    std::string title, x_label, y_label;
    std::vector<PlotSeries> series;  ///< the eighth series has the colour of the first, but another mark
    int width = 720, height = 480;   ///< pixels
};

/// Self-contained: no external style or font.
std::string svg_of(const Plot& plot);
Image8 picture_of(const Plot& plot);

}  // namespace shvr::report

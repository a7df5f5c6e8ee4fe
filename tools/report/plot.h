#pragma once
// Log-log scatter plots, as SVG and as pixels, drawn by one code: marks of families in colours that people with any
// colour vision tell apart (Okabe and Ito 2008) and in shapes of their own, a line along the front, labels. Any thread.

#include <string>
#include <vector>

#include "engine/base/image.h"

namespace shvr::report {

struct PlotPoint {
    double x = 1.0, y = 1.0;  ///< what is not above 0 is left out
    std::string label;        ///< beside the mark; empty: none
    bool on_front = false;    ///< joined by a line; the others are paler, unless they have a label
};

struct PlotSeries {
    std::string name;
    std::vector<PlotPoint> points;
    bool is_joined = false;  ///< a line of its colour from point to point, all of which are full
    bool is_other = false;   ///< what the others are compared with: full, in the ink of the axes
};

struct Plot {
    std::string title, x_label, y_label;
    std::vector<PlotSeries> series;  ///< the eighth has the first one's colour, with another mark
    int width = 720, height = 480;   ///< pixels
};

/// Standing alone: no style and no font comes from elsewhere.
std::string svg_of(const Plot& plot);
Image8 picture_of(const Plot& plot);

}  // namespace shvr::report

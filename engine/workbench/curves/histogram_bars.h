#pragma once
// The histogram of a volume as bars to draw, whose widths suit the values that the volume can hold. Pure; any thread.

#include <vector>

#include "engine/session/session.h"

namespace shvr::ui {

struct HistogramBar {
    double lower = 0.0, upper = 0.0;  ///< intensities
    double voxels = 0.0;              ///< voxels per possible value in the bar; for floats, voxels in the whole bar
};
struct HistogramBars {
    std::vector<HistogramBar> bars;
    std::vector<HistogramBar> fill{};  ///< one bar for each fill value, outside the range of all other values
    /// Step between possible voxel values, which are the minimum plus multiples of it (rounded if it is no whole
    /// number); 0 if voxels are floats or the step is unknown.
    double step = 0.0;
};

/// Volumes are measured in 256 bins, into which a varying number of integer values fall. Drawn directly, the smooth
/// histogram of a volume with 300 grey values would look like a comb, as would that of values that are multiples of a
/// step. Bars therefore count voxels per possible value, and bars without a possible value are merged with others.
HistogramBars histogram_bars(VoxelType type, const VolumeStatistics& statistics);

/// Returns the height of a bar, 0 ... 1; `most` is the maximum count.
double height_of_bar(double voxels, double most, bool is_logarithmic);

}  // namespace shvr::ui

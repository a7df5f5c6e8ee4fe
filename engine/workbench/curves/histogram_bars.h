#pragma once
// The histogram of a volume as bars to draw, in bins that suit the values of its voxel type. Pure; any thread.

#include <vector>

#include "engine/session/session.h"

namespace shvr::ui {

struct HistogramBar {
    double lower = 0.0, upper = 0.0;  ///< intensities
    double voxels = 0.0;              ///< number per possible voxel value within the bar; for floats, in the whole bar
};
struct HistogramBars {
    std::vector<HistogramBar> bars;
    std::vector<HistogramBar> fill{};  ///< one bar per fill value; these lie outside all other values
    /// Voxel values are the minimum plus multiples of this step, rounded if the step is not a whole number; 0: voxels
    /// are floats, or the step is unknown.
    double step = 0.0;
};

/// Volumes are measured in 256 bins, and the number of integer voxel values per bin varies by one. Drawn directly, the
/// smooth histogram of a volume with 300 grey values looks like a comb, as does that of values that are multiples of a
/// step. So bars count voxels per possible value, and bars without a possible value are joined with others.
HistogramBars histogram_bars(VoxelType type, const VolumeStatistics& statistics);

/// Returns the height of a bar, 0 ... 1; `most` is the maximum count.
double height_of_bar(double voxels, double most, bool is_logarithmic);

}  // namespace shvr::ui

#pragma once
// The histogram of a volume as bars to draw, in bins that suit what its voxels can hold. Pure; any thread.

#include <vector>

#include "engine/session/session.h"

namespace shvr::ui {

struct HistogramBar {
    double lower = 0.0, upper = 0.0;  ///< intensities
    double voxels = 0.0;              ///< for each value that voxels may have within; for floats, in all of the bar
};
struct HistogramBars {
    std::vector<HistogramBar> bars;
    /// Voxels are multiples of this above the least one, rounded where it is no whole number; 0: floats, or nothing is
    /// known.
    double step = 0.0;
};

/// Volumes are measured in 256 bins, which hold now more and now fewer of the whole numbers that voxels can be: as they
/// are drawn, a smooth histogram of a volume of 300 grey values is a comb, and so is one whose values are multiples of
/// something. So bars count voxels for each value that they may have; where a bar holds none, they are joined.
HistogramBars histogram_bars(VoxelType type, const VolumeStatistics& statistics);

/// Height of a bar, 0 ... 1, where `most` is the largest.
double height_of_bar(double voxels, double most, bool is_logarithmic);

}  // namespace shvr::ui

#pragma once
// Converts the numbers in a file to intensities by a slope and an intercept (NIfTI, DICOM). Any thread may call these.

#include <memory>
#include <span>

#include "engine/volume/source.h"

namespace shvr {

/// intensity = slope * stored + intercept. Both are finite, and the slope is not 0.
struct Rescale {
    double slope = 1.0;
    double intercept = 0.0;
    std::optional<ValueRange> stored{};  ///< range of the stored values, if their type could hold more

    bool changes_nothing() const { return slope == 1.0 && intercept == 0.0; }
};

/// Returns the type that holds the intensities, never smaller than the stored type. Integers stay integers if slope and
/// intercept are whole. Otherwise, 8- and 16-bit types and float32 become float32, and larger types become float64.
VoxelType rescaled_type(VoxelType stored, const Rescale& rescale);

/// Converts `stored` to `intensities`. If `to` is not smaller than `from`, `stored` may lie at the end of the memory of
/// `intensities`. `to` must be able to hold the results.
void rescale_voxels(VoxelType from, std::span<const std::byte> stored, const Rescale& rescale, VoxelType to,
                    std::span<std::byte> intensities);

/// Returns `source`, which must have one level, with its voxels converted to intensities, or `source` itself if nothing
/// changes. Adds a warning if integers become floats.
std::unique_ptr<VolumeSource> rescaled(std::unique_ptr<VolumeSource> source, const Rescale& rescale);

}  // namespace shvr

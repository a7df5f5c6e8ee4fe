#pragma once
// Intensities that a file stores as numbers with a slope and an intercept (NIfTI, DICOM). Any thread may call these.

#include <memory>
#include <span>

#include "engine/volume/source.h"

namespace shvr {

/// intensity = slope * stored + intercept; both finite, slope not 0.
struct Rescale {
    double slope = 1.0;
    double intercept = 0.0;
    std::optional<ValueRange> stored{};  ///< what stored numbers can be, where that is less than their type holds

    bool changes_nothing() const { return slope == 1.0 && intercept == 0.0; }
};

/// The type that holds the intensities, never smaller than the stored one. Integers stay integers where slope and
/// intercept are whole; else 8 and 16 bits and float32 become float32, the larger ones float64.
VoxelType rescaled_type(VoxelType stored, const Rescale& rescale);

/// `stored` to `intensities`, which may be the end and the whole of the same memory where `to` is not smaller than
/// `from`. `to` must hold what comes out.
void rescale_voxels(VoxelType from, std::span<const std::byte> stored, const Rescale& rescale, VoxelType to,
                    std::span<std::byte> intensities);

/// `source`, which has one level, in its intensities; itself where nothing changes. A warning says where integers
/// become floats.
std::unique_ptr<VolumeSource> rescaled(std::unique_ptr<VolumeSource> source, const Rescale& rescale);

}  // namespace shvr

#pragma once
// Converts voxels from a file's format to the 16-bit codes of an `IntensityWindow`, a row at a time. Any thread.

#include <span>

#include "engine/volume/volume.h"

namespace shvr {

/// code = round((voxel - lower) * codes_per_unit), clamped to 0 ... 65535 (integers above the window get the code of
/// the last integer inside it); NaN becomes 0. `voxels` has native byte order and need not be aligned; it holds exactly
/// `codes.size()` voxels.
class CodeRows {
public:
    CodeRows(VoxelType type, const IntensityWindow& window);

    void convert(std::span<const std::byte> voxels, std::span<uint16_t> codes) const;

private:
    VoxelType type_;
    IntensityWindow window_;
    bool is_whole_;  ///< lower and codes_per_unit are whole numbers in the range of the voxels
};

}  // namespace shvr

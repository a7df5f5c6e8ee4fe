#pragma once
// A mask as a segmentation of 3D Slicer (.seg.nrrd): names, colours and extents of its segments, which are groups.

#include <array>
#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "engine/annotation/mask.h"
#include "engine/formats/nrrd_head.h"
#include "engine/projects/import_volume.h"
#include "engine/volume/source.h"

namespace shvr {

/// The key/value pairs to set in the NRRD file at `path` (a segmentation, or a file that will be one) when this mask
/// replaces its voxels. Segments keep their numbers and all other keys; groups without a segment get one. Empty if
/// neither the name ends in .seg.nrrd nor the present file has segments. `looks`: names and colours of groups.
std::vector<NrrdPair> segment_pairs(const std::filesystem::path& path, const Mask& mask,
                                    const std::vector<LabelImage::Color>& looks);

/// Merges the layers of a segmentation, whose segments may overlap, into one volume of groups. A voxel belongs to the
/// group of its segment (NrrdSegment::group); if several segments contain it, to that of the segment in the last layer.
class LayeredMask final : public VolumeSource {
public:
    /// Opens each layer of the file, at least one.
    LayeredMask(const std::filesystem::path& path, int64_t layers, const std::vector<NrrdSegment>& segments);

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override;

    /// Number of voxels, among those read so far, that belong to more than one segment.
    int64_t overlaps() const { return overlaps_; }

private:
    std::string file_;
    std::vector<std::unique_ptr<VolumeSource>> layers_;
    std::vector<std::array<uint8_t, 256>> groups_;  ///< by layer and label value
    mutable std::atomic<int64_t> overlaps_ = 0;
};

}  // namespace shvr

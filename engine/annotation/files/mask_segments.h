#pragma once
// A mask as a 3D Slicer segmentation (.seg.nrrd): each group is a segment with a name, a colour and an extent. All
// other content of an NRRD mask's header is kept.

#include <array>
#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/annotation/mask.h"
#include "engine/formats/nrrd_head.h"
#include "engine/projects/import_volume.h"
#include "engine/volume/source.h"

namespace shvr {

/// Returns the header of an NRRD mask, or the NRRD header kept in a label image; null if there is none or it cannot be
/// read. SHVR does not interpret all of it (terminology, keys of other programs), but keeps it in saves and exports.
std::optional<NrrdHead> mask_header(const std::filesystem::path& mask);
/// Returns the header to keep when a mask is saved as `path`: `earlier` or, if `path` holds a mask, that mask's header
/// plus the segments that only `earlier` has, with their keys. Segments are identified by their group.
std::optional<NrrdHead> header_to_keep(const std::filesystem::path& path, const std::optional<NrrdHead>& earlier);

/// Describes the groups of this mask as segments in the header of an NRRD file. Segments in `head` keep their numbers
/// and all their other keys; groups without a segment get a new one. Does nothing unless the file's name ends in
/// .seg.nrrd or the header has segments. `looks`: names and colours of groups.
void describe_segments(NrrdHead& head, const std::filesystem::path& path, const Mask& mask,
                       const std::vector<LabelImage::Color>& looks);

/// Merges the layers of a segmentation, whose segments may overlap, into one volume of groups. A voxel gets the group
/// of its segment (NrrdSegment::group); if several segments contain the voxel, the segment in the last layer wins.
class LayeredMask final : public VolumeSource {
public:
    /// Opens each layer of the file. The file must have at least one.
    LayeredMask(const std::filesystem::path& path, int64_t layers, const std::vector<NrrdSegment>& segments);

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override;

    /// Number of voxels read so far that belong to more than one segment.
    int64_t overlaps() const { return overlaps_; }

private:
    std::string file_;
    std::vector<std::unique_ptr<VolumeSource>> layers_;
    std::vector<std::array<uint8_t, 256>> groups_;  ///< by layer and label value
    mutable std::atomic<int64_t> overlaps_ = 0;
};

}  // namespace shvr

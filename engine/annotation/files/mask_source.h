#pragma once
// Presents a mask as a volume of groups, and converts such a volume to a mask, for export and import of masks. Any
// thread may call these.

#include "engine/annotation/files/sparse_source.h"
#include "engine/annotation/mask.h"

namespace shvr {

class MaskSource final : public SparseSource<uint8_t> {
public:
    /// `volume`, which has the mask's size, gives the voxels' positions. The mask must outlive this object, unchanged.
    MaskSource(const Mask& mask, const VolumeInfo& volume);
};

/// Returns, in ascending order, the records that turn an unpainted mask of the volume's size into `groups`. The cost is
/// proportional to the data that the source stores. Voxels may be of any type. Fails if a voxel is not a whole number
/// from 0 to 255: naming `file` and the voxel or, if all are labels as of other programs, how many there are and
/// the highest.
std::vector<MaskBrickChange> mask_changes(const VolumeSource& groups, const std::string& file);

/// The voxels of a box of a mask as groups; fails like `mask_changes`.
std::vector<uint8_t> groups_in(const VolumeSource& mask, const VoxelBox& box, const std::string& file);

}  // namespace shvr

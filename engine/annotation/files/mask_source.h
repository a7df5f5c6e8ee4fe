#pragma once
// A mask as a volume of groups, and a volume of groups as a mask: what masks in other programs' forms go through.
// Any thread may call these.

#include "engine/annotation/mask.h"
#include "engine/volume/source.h"

namespace shvr {

class MaskSource final : public VolumeSource {
public:
    /// `volume`, whose size is the mask's, says where the voxels lie. The mask must outlive it, unchanged.
    MaskSource(const Mask& mask, const VolumeInfo& volume);

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override;

private:
    const Mask& mask_;
};

/// The records that make an unpainted mask of the volume's size hold its voxels. Fails, naming `file`, where these are not
/// uint8.
std::vector<MaskBrickChange> mask_changes(const VolumeSource& groups, const std::string& file);

}  // namespace shvr

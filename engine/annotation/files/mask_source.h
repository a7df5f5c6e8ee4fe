#pragma once
// A mask as a volume of groups, and a volume of groups as a mask: masks are exported and imported through these.
// Any thread may call these.

#include "engine/annotation/mask.h"
#include "engine/volume/source.h"

namespace shvr {

class MaskSource final : public VolumeSource {
public:
    /// `volume`, of the mask's size, gives the voxels' positions. The mask must outlive this, unchanged.
    MaskSource(const Mask& mask, const VolumeInfo& volume);

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override;

private:
    const Mask& mask_;
};

/// The records that turn an unpainted mask of the volume's size into the volume. Fails, naming `file`, where its voxels
/// are not uint8.
std::vector<MaskBrickChange> mask_changes(const VolumeSource& groups, const std::string& file);

}  // namespace shvr

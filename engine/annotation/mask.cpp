#include "engine/annotation/mask.h"

#include "engine/base/error.h"

namespace shvr {

Mask::Mask(const Size3& size) : SparseBricks(size)
{
    voxels_by_group_[0] = size.x * size.y * size.z;
}

std::string Mask::why_it_does_not_fit(const MaskBrickChange& change, Direction direction) const
{
    return SparseBricks::why_it_does_not_fit(change, direction,
                                             [](uint8_t group) { return sentence("group ", int(group)); });
}

void Mask::apply(const MaskBrickChange& change, Direction direction)
{
    const std::string reason = why_it_does_not_fit(change, direction);
    SHVR_CHECK(reason.empty(), reason);
    replace(change, direction, [&](uint8_t from, uint8_t to, int64_t voxels) {
        voxels_by_group_[from] -= voxels;
        voxels_by_group_[to] += voxels;
    });
}

}  // namespace shvr

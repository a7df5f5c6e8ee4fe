#include "engine/annotation/density.h"

#include <cmath>

#include "engine/base/error.h"

namespace shvr {

std::string DensityField::why_it_does_not_fit(const DensityBrickChange& change, Direction direction) const
{
    return SparseBricks::why_it_does_not_fit(
        change, direction, [&](uint32_t bits) { return sentence("offset ", offset_of(type_, bits)); },
        // NaN is not within the limit
        [&](uint32_t bits) { return std::abs(offset_of(type_, bits)) <= offset_limit(type_); });
}

void DensityField::apply(const DensityBrickChange& change, Direction direction)
{
    const std::string reason = why_it_does_not_fit(change, direction);
    SHVR_CHECK(reason.empty(), reason);
    replace(change, direction,
            [&](uint32_t from, uint32_t to, int64_t voxels) { voxels_ += voxels * (int(to != 0) - int(from != 0)); });
}

}  // namespace shvr

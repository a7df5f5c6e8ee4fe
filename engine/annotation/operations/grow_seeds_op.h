#pragma once
// Parameters of growing from seeds.

#include <vector>

#include "engine/annotation/operations/operation_limits.h"

namespace shvr {

/// Grows painted groups, the seeds, until they meet: a watershed by flooding in the order of costs (Meyer 1994). Only
/// voxels that may change are flooded; the others are walls. Groups that are locked neither grow nor change.
struct GrowSeedsOp {
    enum class On {
        gradient,   ///< the cost of a voxel is the magnitude of the gradient: borders lie on edges
        intensity,  ///< its intensity: dark voxels come first, and borders lie on bright ridges
        inverted    ///< bright voxels come first, and borders lie in dark valleys
    };
    std::vector<uint8_t> groups{};  ///< the seeds; empty: all groups except `limits.inside`
    On on = On::gradient;
    /// How far the groups grow beyond the box around the seeds, in voxels; null: MARGIN without a box, otherwise any.
    std::optional<int64_t> margin{};
    OperationLimits limits{};
    static constexpr bool READS_INTENSITIES = true;
    static constexpr int64_t MARGIN = 16;
};
inline constexpr Spelling<GrowSeedsOp::On> SEED_COSTS[] = {{GrowSeedsOp::On::gradient, "gradient"},
                                                           {GrowSeedsOp::On::intensity, "intensity"},
                                                           {GrowSeedsOp::On::inverted, "inverted"}};
constexpr std::span<const Spelling<GrowSeedsOp::On>> spellings_of(GrowSeedsOp::On)
{
    return SEED_COSTS;
}

}  // namespace shvr

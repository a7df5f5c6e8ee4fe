#pragma once
// Tracks which part of the leap grid on the device is stale, and schedules its rebuild. A new look (transfer function,
// visible groups) needs a full rebuild before anything is drawn. If only a few cells changed, a patch is enough for
// pictures, and the rest is rebuilt when idle. Used only by the renderer's thread.

#include <optional>

#include "engine/passes/leap_grid.h"

namespace shvr {

class EmptySpace {
public:
    /// Reports that the contents of these cells may have changed.
    void changed(const CellBox& cells);
    /// Sets the look for which the grid is built. The members `changed` and `mask` of `look` are ignored.
    void want(const LeapGridInput& look, const glm::uvec3& cell_counts);

    /// is_due(): work must be done before the next picture. is_worth_refining(): other work can be done after it.
    bool is_due() const { return look_ && (!holds_ || !patch_.empty()); }
    bool is_worth_refining() const { return look_ && holds_ && stage_ < LEAP_STAGES; }
    /// Each function adds one pass of the work that prepares or refines the grid. Call it only while there is such
    /// work. If the graph is not submitted afterwards, the whole grid is rebuilt.
    void prepare(FrameGraph& graph, VolumeBinding& volume, LeapGridInput look);
    void refine(FrameGraph& graph, VolumeBinding& volume, LeapGridInput look);

private:
    void forget_unless_submitted(FrameGraph& graph);

    std::optional<LeapGridInput> look_;  ///< the look for which the grid is built, without its mask handles
    bool holds_ = false;                 ///< pictures are correct, except for the patch
    CellBox patch_;                      ///< changed cells that are not yet reflected in the grid
    uint32_t stage_ = 0;                 ///< index of the next stage, up to LEAP_STAGES
    CellBox changed_;                    ///< cells covered by the stages in progress
    glm::uvec3 cell_counts_{0};          ///< the size of the whole grid
};

}  // namespace shvr

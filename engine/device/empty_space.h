#pragma once
// What of the leap grid on the device is out of date, and when it is built again. A new look (transfer function,
// visible groups) needs all of it before anything is drawn; where a few cells changed, a patch is enough for pictures,
// and the rest is built when there is nothing else to do. One thread, the renderer's.

#include <optional>

#include "engine/passes/leap_grid.h"

namespace shvr {

class EmptySpace {
public:
    /// These cells may show other things than before.
    void changed(const CellBox& cells);
    /// What cells are to show by; `changed` and `mask` of it do not matter.
    void want(const LeapGridInput& look, const glm::uvec3& cell_counts);

    /// Whether there is something left to do before a picture, and after it.
    bool is_due() const { return look_ && (!holds_ || !patch_.empty()); }
    bool is_worth_refining() const { return look_ && holds_ && stage_ < LEAP_STAGES; }
    /// Adds one pass of what is due; of both, only where there is one.
    void prepare(FrameGraph& graph, VolumeBinding& volume, LeapGridInput look);
    void refine(FrameGraph& graph, VolumeBinding& volume, LeapGridInput look);

private:
    std::optional<LeapGridInput> look_;  ///< what the grid is built from, but for paint
    bool holds_ = false;                 ///< pictures come out right, but for the patch
    CellBox patch_;                      ///< cells that the grid does not know of yet
    uint32_t stage_ = 0;                 ///< the next of LEAP_STAGES
    CellBox changed_;                    ///< the cells that the stages are about
};

}  // namespace shvr

#pragma once
// Collects the changes that an operation wants, brick by brick, and decides which voxels may change: locks, limits and
// the volume's border are applied only here. The result is the records of one undoable step, with counts of changes and
// of bricks read and written. One thread.

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/annotation/brush.h"
#include "engine/annotation/mask.h"
#include "engine/annotation/operations/operation_limits.h"
#include "engine/annotation/stroke_result.h"
#include "engine/annotation/trace/tracing.h"
#include "engine/volume/source.h"

namespace shvr {

/// The input of operations. Bricks of a mask are immutable, so a copy of a mask may be read on another thread.
struct OperationInput {
    const Mask& mask;
    const VolumeInfo& volume;
    const VolumeSource* source = nullptr;  ///< intensities, with density offsets; null if there are none
    const TraceGraph* trace = nullptr;     ///< null: there is none
    GroupSet locked{};
    uint64_t memory = 0;  ///< most bytes that the operation itself may allocate; 0: no limit
};

struct OperationResult {
    std::vector<MaskBrickChange> changes{};  ///< in ascending order of bricks
    std::vector<TraceChange> trace_changes{};
    int64_t voxels = 0;  ///< that change their group
    /// Voxels by their groups before and after.
    std::map<std::pair<uint8_t, uint8_t>, int64_t> moved{};
    StrokeResult::ByGroup kept_locked{};  ///< by locked group: voxels unchanged because it is their old or wanted group
    int64_t kept_by_limits = 0;           ///< voxels that stay because of OperationLimits
    std::string note{};                   ///< what the operation found, as in "3 holes"
    /// Cost: number of mask bricks read (each read counts), of bricks changed, and of intensity bricks read.
    int64_t bricks_read = 0, bricks_written = 0, bricks_of_intensities = 0;
};

/// How a sentence puts a result.
struct ResultWords {
    GroupNames name_of{};
    bool is_preview = false;  ///< "would be painted" instead of "painted"
};
/// "Fill holes: 120 voxels painted in group 3 (wood); 2 holes; group 2 is locked, so 7 voxels stayed".
std::string sentence_of(const OperationResult& result, const std::string& title, const ResultWords& words);

class MaskEdit {
public:
    MaskEdit(const OperationInput& input, const OperationLimits& limits);

    const Mask& mask() const { return input_.mask; }
    const OperationInput& input() const { return input_; }
    const OperationLimits& limits() const { return limits_; }
    /// Fails if the input has none.
    const VolumeSource& source() const;
    void count_intensities(int64_t bricks) { result_.bricks_of_intensities += bricks; }
    /// Fails if this many bytes, which the operation is about to allocate, exceed its memory budget.
    void check_memory(uint64_t bytes) const;
    /// Returns a brick of the mask, all zeros if it is unpainted, and counts the read.
    const MaskBrick& read(int64_t brick);
    /// Whether any voxel of the brick lies in the limits' box and behind their plane. If none does, `want` ignores the
    /// brick.
    bool may_change(int64_t brick) const;
    bool is_behind_plane(const Size3& voxel) const
    {
        return glm::dot(glm::dvec3(plane_), glm::dvec3(voxel) + 0.5) + plane_.w <= 0.0;
    }
    /// Records the change of a brick to `wanted`, except for voxels that may not change. Call at most once per brick.
    void want(int64_t brick, const MaskBrick& wanted);
    void change_trace(std::vector<TraceChange> changes) { result_.trace_changes = std::move(changes); }
    void note(std::string text) { result_.note = std::move(text); }
    OperationResult take();

private:
    bool is_within(int64_t brick, size_t index);
    /// Whether locks and limits let the run change. With a range of intensities, the run must be one voxel.
    bool changes(int64_t brick, const MaskRun& run);
    void want_row(MaskBrickChange& change, const MaskBrick& held, const MaskBrick& wanted, size_t first, size_t end);

    const OperationInput& input_;
    const OperationLimits& limits_;
    glm::dvec4 plane_;  ///< plane_in_voxels
    OperationResult result_;
    int64_t intensities_of_ = -1;  ///< the brick whose voxels' intensities are in `intensities_`
    std::vector<double> intensities_;
    uint64_t bytes_ = 0;
};

}  // namespace shvr

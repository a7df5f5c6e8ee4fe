#pragma once
// An annotator's workplace without a window: a modelled Touch in a modelled hand, the servo loop at 1 kHz with
// relevance as late as in a window, the annotation with its undo history, and a clock. Tools act where the program's
// tools do: in the middle of the touched object or, without contact, at the probe.
//
// `spend` advances the clock without simulating ticks, while the hand rests. Equal seeds give equal bits. One thread.

#include <memory>
#include <optional>

#include "engine/annotation/trace/trace_command.h"
#include "engine/annotation/work/work.h"
#include "engine/study/hand.h"
#include "engine/study/rows.h"
#include "engine/study/scene.h"
#include "haptics/force.h"
#include "haptics/replay/late_relevance.h"
#include "haptics/replay/modelled_touch.h"

namespace shvr {

/// The time limit of a task: ten minutes (thesis, chapter 6).
inline constexpr double MAX_STUDY_S = 600.0;
inline constexpr double STUDY_TICK_S = 0.001;

/// Sums over the ticks.
struct TouchTally {
    uint64_t ticks = 0, in_contact = 0;
    double force_sum_n = 0.0, force_most_n = 0.0;
};

class StudyDesk {
public:
    StudyDesk(const StudyScene& scene, const StudyCondition& condition, const HandTraits& traits, uint32_t seed);

    const StudyScene& scene() const { return scene_; }
    double seconds() const { return seconds_; }
    bool is_over() const { return seconds_ >= MAX_STUDY_S; }
    void spend(double seconds) { seconds_ += seconds; }

    /// Places the hand at a voxel position without feeling anything on the way; the force fades in again.
    void place(const glm::dvec3& voxel);
    /// Sets the direction to the eye, in which a surface releases the probe.
    void look_from(const glm::dvec3& to_eye) { force_.to_camera = to_eye; }
    /// Simulates a tick in which the hand aims at `aim`, and strays from it. `speed`: of the aimed place, voxels per
    /// second. `acts`: whether a tool acts at the end of the tick, so that the tool's place is computed.
    const ForceStep& tick(const glm::dvec3& aim, double speed, bool acts = false);
    const ForceStep& step() const { return step_; }
    /// Where a tool acts, after a tick with `acts`; after other ticks, where the probe is drawn.
    glm::dvec3 tool() const { return step_.in_contact ? step_.middle : step_.probe; }
    bool feels() const { return force_.assistance && step_.in_contact; }

    double probe_radius() const { return force_.probe_radius; }
    /// Runs an operation on the trace. Returns false if it is impossible, as when no node is near enough to select.
    bool edit_trace(const TraceOp& op);
    /// Paints with the probe's ball along a path, as one command. Returns the number of voxels that changed.
    int64_t paint(std::vector<glm::dvec3> path, double threshold);
    void undo();
    const Document& document() const { return work_.document(); }

    uint32_t presses() const { return presses_; }
    uint32_t undos() const { return undos_; }
    /// Writes the outcomes to the row: time, presses, undos, contact, energy and forces.
    void put_outcomes(StudyRow& row) const;

private:
    const StudyScene& scene_;
    ModelledTouch touch_;
    LateRelevance relevance_;
    ForceSettings force_;
    ForceMemory memory_;
    std::unique_ptr<GrowthMemory> growth_;
    ForceStep step_;
    DeviceState state_;
    StudyRandom random_;
    HandStray stray_;
    double scale_;  ///< voxels per metre in the hand
    double seconds_ = 0.0;
    uint64_t servo_ns_ = 0;
    uint32_t jump_ = 1;
    TouchTally tally_;
    uint32_t presses_ = 0, undos_ = 0;
    Work work_;
};

}  // namespace shvr

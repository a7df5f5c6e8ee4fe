#pragma once
// Measures how well an annotation agrees with the ground truth, for `shvr evaluate`. Any thread.

#include "engine/annotation/measures/trace_score.h"
#include "engine/annotation/trace/trace_space.h"
#include "engine/tasks/task_options.h"

namespace shvr {

struct EvaluateTask {
    static constexpr const char* TITLE = "Compare with a reference";

    std::filesystem::path truth_mask, mask, truth_trace, trace;
    std::filesystem::path volume;           ///< size, spacing and unit of inputs whose files do not state these
    std::vector<std::string> truth_groups;  ///< "FROM=TO"
    std::optional<double> slack;            ///< tolerance in the volume's unit; null: the longest side of a voxel
    bool allows_incomplete = false;         ///< counts unreadable voxels of masks as unpainted
    std::vector<std::string> settings;      ///< "key=value" settings of a session, for `volume`
    OptionNames names = OptionNames::keys;  ///< how messages name options; not an option itself
};
void fields(Fields& f, EvaluateTask& task);

/// Results that were not requested are null.
struct EvaluateResult {
    std::optional<TraceSpace> space;
    std::optional<Dice> dice;
    std::optional<BallScores> nodes, internodes;
    std::optional<TraceComparison> traces;
    std::optional<double> slack;
    int64_t voxels_not_read = 0;  ///< number in both masks together
    std::vector<std::string> warnings;
};

/// Refuses missing or malformed options; reads nothing.
void check(const EvaluateTask& task);
EvaluateResult run(const EvaluateTask& task, ProgressReporter& reporter);

}  // namespace shvr

#pragma once
// The results of a study: one row per annotation made by a simulated annotator. Any thread.

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "engine/base/spelling.h"
#include "engine/touch/touch_mode.h"

namespace shvr {

enum class StudyTask : uint8_t { paint, trace };
inline constexpr Spelling<StudyTask> STUDY_TASKS[] = {{StudyTask::paint, "paint"}, {StudyTask::trace, "trace"}};
constexpr std::span<const Spelling<StudyTask>> spellings_of(StudyTask)
{
    return STUDY_TASKS;
}

/// The touch mode of a condition: no force, or the force of a TouchMode.
enum class StudyTouch : uint8_t { none, surface, proximity, object };
inline constexpr Spelling<StudyTouch> STUDY_TOUCHES[] = {{StudyTouch::none, "none"},
                                                         {StudyTouch::surface, "surface"},
                                                         {StudyTouch::proximity, "proximity"},
                                                         {StudyTouch::object, "object"}};
constexpr std::span<const Spelling<StudyTouch>> spellings_of(StudyTouch)
{
    return STUDY_TOUCHES;
}

struct StudyCondition {
    StudyTask task = StudyTask::trace;
    StudyTouch touch = StudyTouch::object;
    ProxyLaw law = ProxyLaw::potential;
    double probe_radii = 1.5;  ///< radius of the probe / mean radius of the veins
    double noise = 10.0;       ///< PhantomFlaws::noise
    bool operator==(const StudyCondition&) const = default;
};

/// The columns of a row. The columns of the thesis's table 6.1 come first.
enum class Outcome : uint8_t {
    dice_partial,
    dice_full,
    node_score,
    nodes_out,
    nodes,
    internode_score,
    internodes_out,
    internodes,
    segments_found,
    segments_total,
    topological_errors,
    centreline_rms,
    centreline_most,
    seconds,
    segments_per_minute,
    presses,
    undos,
    contact,
    energy,
    force_mean,
    force_most,
};
/// The outcome by which a task is judged, fixed before conditions were compared. All other outcomes are exploratory.
constexpr Outcome main_outcome(StudyTask task)
{
    return task == StudyTask::paint ? Outcome::dice_partial : Outcome::centreline_rms;
}
inline constexpr size_t OUTCOMES = size_t(Outcome::force_most) + 1;

struct OutcomeColumn {
    Outcome outcome;
    std::string_view name;     ///< heading of the column in the CSV file
    std::string_view unit;     ///< "1" for ratios and counts
    int better;                ///< 1 if higher is better, -1 if lower is better, 0 if neither
    std::string_view meaning;  ///< a sentence for the codebook
};
std::span<const OutcomeColumn> outcome_columns();

struct StudyRow {
    StudyCondition condition;
    uint32_t annotator = 0;               ///< number of the simulated annotator, from 1
    uint32_t seed = 0;                    ///< seed of phantom and hand; rows with equal seeds form pairs
    std::array<double, OUTCOMES> values;  ///< NaN for outcomes that the task does not measure
    double operator[](Outcome outcome) const { return values[size_t(outcome)]; }
};

/// Returns a CSV file (RFC 4180) with a header: task, touch, law, probe_radii, noise, annotator, seed, then the names
/// of `outcome_columns()`. NaN becomes an empty field. Numbers have enough digits to be read back as the same bits.
std::string csv_of(std::span<const StudyRow> rows);
/// Reads the file that `csv_of` writes. Fails with a message that names file, line and column.
std::vector<StudyRow> read_study_rows(const std::filesystem::path& file);

}  // namespace shvr

#pragma once
// The results of a study: one row for each annotation that a simulated annotator makes. Any thread.

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

/// The touch of a condition: no force at all, or the force of a TouchMode.
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

/// The columns of a row. Those of the thesis's table 6.1 come first.
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
/// The outcome by which a task is judged, named before any condition was compared. All others are exploratory.
constexpr Outcome main_outcome(StudyTask task)
{
    return task == StudyTask::paint ? Outcome::dice_partial : Outcome::centreline_rms;
}
inline constexpr size_t OUTCOMES = size_t(Outcome::force_most) + 1;

struct OutcomeColumn {
    Outcome outcome;
    std::string_view name;     ///< heading of the column of a CSV file
    std::string_view unit;     ///< "1" for ratios and counts
    int better;                ///< 1 where more is better, -1 where less is, 0 where neither
    std::string_view meaning;  ///< a sentence for the codebook
};
std::span<const OutcomeColumn> outcome_columns();

struct StudyRow {
    StudyCondition condition;
    uint32_t annotator = 0;               ///< number of the simulated annotator, from 1
    uint32_t seed = 0;                    ///< seed of its phantom and its hand; equal seeds are paired
    std::array<double, OUTCOMES> values;  ///< NaN where the task has no such outcome
    double operator[](Outcome outcome) const { return values[size_t(outcome)]; }
};

/// A CSV file (RFC 4180) with a header: task, touch, law, probe_radii, noise, annotator, seed, then the names of
/// `outcome_columns()`. NaN is an empty field. Numbers are written so that they read back as the same bits.
std::string csv_of(std::span<const StudyRow> rows);
/// Fails with a sentence that names file, line and column.
std::vector<StudyRow> read_study_rows(const std::filesystem::path& file);

}  // namespace shvr

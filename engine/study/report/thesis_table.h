#pragma once
// Table 6.1 of the thesis, for display next to the simulated results. Any thread.

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

#include "engine/study/rows.h"

namespace shvr {

/// The source of the numbers, as a sentence for the report.
inline constexpr char THESIS_SOURCE[] =
    "Table 6.1 of the thesis in which SHVR was first described: ten people, one section of a Gerbera head, ten minutes "
    "for each task. They chose and changed the mode of touch as they liked.";

/// The results of one participant. `participant` 0: the reference annotation.
struct ThesisRow {
    int participant = 0;
    double dice_partial, dice_full;
    double node_score;
    int nodes_out, nodes;
    double internode_score;
    int internodes_out, internodes, segments_found, topological_errors;
    /// Returns the value in a column of a study's rows; null for columns that the thesis lacks.
    std::optional<double> value(Outcome outcome) const;
};
/// The truth first, then the ten participants.
std::span<const ThesisRow> thesis_rows();

}  // namespace shvr

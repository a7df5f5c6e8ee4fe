#include "engine/study/rows.h"

#include <cmath>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/study/study_lines.h"

namespace shvr {

namespace {

using enum Outcome;
constexpr OutcomeColumn COLUMNS[] = {
    {dice_partial, "dice_partial", "1", 1, "Dice against the bundles that are joined to adaxial veins (eq. 6.1)."},
    {dice_full, "dice_full", "1", 1, "Dice against all bundles (eq. 6.1)."},
    {node_score, "node_score", "1", 1, "Mean share of the balls of nodes inside all bundles (eq. 6.2)."},
    {nodes_out, "nodes_out", "1", -1, "Nodes whose share is below one half."},
    {nodes, "nodes", "1", 0, "Nodes of the trace."},
    {internode_score, "internode_score", "1", 1, "The node score of balls at the middles of internodes."},
    {internodes_out, "internodes_out", "1", -1, "Internodes whose share is below one half."},
    {internodes, "internodes", "1", 0, "Internodes of the trace."},
    {segments_found, "segments_found", "1", 1, "Segments of the true trace that were traced from end to end."},
    {segments_total, "segments_total", "1", 0, "Segments of the true trace."},
    {topological_errors, "topological_errors", "1", -1, "Errors of topology of all kinds."},
    {centreline_rms, "centreline_rms", "voxel", -1, "Root mean square distance of the trace from the true axes."},
    {centreline_most, "centreline_most", "voxel", -1, "Largest distance of the trace from the true axes."},
    {seconds, "seconds", "s", -1, "Simulated time until the task was finished, or the limit."},
    {segments_per_minute, "segments_per_minute", "1/min", 1, "Segments found in a simulated minute."},
    {presses, "presses", "1", 0, "Presses of the stylus's button."},
    {undos, "undos", "1", -1, "Steps that were undone."},
    {contact, "contact", "1", 0, "Share of ticks with a force."},
    {energy, "energy", "mJ", 0, "Work that the device did on the hand."},
    {force_mean, "force_mean", "N", 0, "Mean force over the ticks in contact."},
    {force_most, "force_most", "N", 0, "Largest force."},
};
static_assert(std::size(COLUMNS) == OUTCOMES);

constexpr std::string_view KEYS[] = {"task", "touch", "law", "probe_radii", "noise", "annotator", "seed"};

std::vector<std::string_view> names_of_fields()
{
    std::vector<std::string_view> names(std::begin(KEYS), std::end(KEYS));
    for (const OutcomeColumn& column : COLUMNS) names.push_back(column.name);
    return names;
}

StudyRow row_of(const StudyLine& line)
{
    StudyRow row{.condition = line.condition(), .annotator = line.whole(5), .seed = line.whole(6), .values = {}};
    for (size_t i = 0; i < OUTCOMES; ++i) row.values[i] = line.number_or_nan(std::size(KEYS) + i);
    return row;
}

}  // namespace

std::span<const OutcomeColumn> outcome_columns()
{
    return COLUMNS;
}

std::string csv_of(std::span<const StudyRow> rows)
{
    std::string csv = study_header(names_of_fields());
    for (const StudyRow& row : rows) {
        const StudyCondition& c = row.condition;
        csv += sentence(spelled(c.task), ',', spelled(c.touch), ',', spelled(c.law), ',', digits_of(c.probe_radii), ',',
                        digits_of(c.noise), ',', row.annotator, ',', row.seed);
        for (const double value : row.values) csv += ',' + (std::isnan(value) ? std::string() : digits_of(value));
        csv += '\n';
    }
    return csv;
}

std::vector<StudyRow> read_study_rows(const std::filesystem::path& file)
{
    std::vector<StudyRow> rows;
    read_study_lines(file, names_of_fields(), [&](const StudyLine& line) { rows.push_back(row_of(line)); });
    return rows;
}

}  // namespace shvr

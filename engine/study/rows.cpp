#include "engine/study/rows.h"

#include <cmath>
#include <limits>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/text.h"

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
constexpr size_t FIELDS = std::size(KEYS) + OUTCOMES;
constexpr int64_t MAX_STUDY_BYTES = int64_t(1) << 28;  // a million rows

std::string header()
{
    std::string line;
    for (const std::string_view key : KEYS) line.append(key).append(",");
    for (const OutcomeColumn& column : COLUMNS) line.append(column.name).append(",");
    line.back() = '\n';
    return line;
}

std::vector<std::string_view> fields_of(std::string_view line)
{
    std::vector<std::string_view> fields;
    for (size_t comma = 0; comma != line.npos; line = comma == line.npos ? line : line.substr(comma + 1)) {
        comma = line.find(',');
        fields.push_back(line.substr(0, comma));
    }
    return fields;
}

/// Parses the fields of one line; failures name its place.
struct LineReader {
    std::string place;
    std::vector<std::string_view> fields;

    [[noreturn]] void refuse(size_t field, std::string_view expected) const
    {
        const std::string_view name = field < std::size(KEYS) ? KEYS[field] : COLUMNS[field - std::size(KEYS)].name;
        fail(place, ", column ", name, ": ", in_quotes(fields[field]), " is not ", expected,
             "; make the file again with `shvr study`");
    }
    template <class Value>
    Value spelled_value(size_t field) const
    {
        std::string expected = "one of";
        for (const Spelling<Value>& each : spellings_of(Value{})) {
            if (each.name == fields[field]) return each.value;
            expected.append(" ").append(each.name);
        }
        refuse(field, expected);
    }
    double number(size_t field) const
    {
        const std::optional<double> number = number_of(fields[field]);
        if (!number || !std::isfinite(*number)) refuse(field, "a finite number");
        return *number;
    }
    uint32_t whole(size_t field) const
    {
        const std::optional<int64_t> number = whole_of(fields[field]);
        if (!number || *number < 0 || *number > std::numeric_limits<uint32_t>::max())
            refuse(field, "a whole number from 0 to 4294967295");
        return uint32_t(*number);
    }
};

StudyRow row_of(const LineReader& line)
{
    StudyRow row{.condition = {.task = line.spelled_value<StudyTask>(0),
                               .touch = line.spelled_value<StudyTouch>(1),
                               .law = line.spelled_value<ProxyLaw>(2),
                               .probe_radii = line.number(3),
                               .noise = line.number(4)},
                 .annotator = line.whole(5),
                 .seed = line.whole(6),
                 .values = {}};
    for (size_t i = 0; i < OUTCOMES; ++i) {
        const size_t field = std::size(KEYS) + i;
        row.values[i] = line.fields[field].empty() ? std::numeric_limits<double>::quiet_NaN() : line.number(field);
    }
    return row;
}

}  // namespace

std::span<const OutcomeColumn> outcome_columns()
{
    return COLUMNS;
}

std::string csv_of(std::span<const StudyRow> rows)
{
    std::string csv = header();
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
    const std::string text = read_text(file, MAX_STUDY_BYTES);
    std::string_view rest = text;
    const std::string_view found = take_line(rest);
    const std::string names = header(), expected = names.substr(0, names.size() - 1);
    if (found != expected)
        fail(file.string(), ": line 1 is ", in_quotes(found), ", not the header of a study's rows, ",
             in_quotes(expected), "; make the file again with `shvr study`");
    std::vector<StudyRow> rows;
    for (size_t number = 2; !rest.empty(); ++number) {
        LineReader line{.place = sentence(file.string(), ": line ", number), .fields = fields_of(take_line(rest))};
        if (line.fields.size() != FIELDS)
            fail(line.place, " has ", line.fields.size(), " fields, not ", FIELDS,
                 "; make the file again with `shvr study`");
        rows.push_back(row_of(line));
    }
    return rows;
}

}  // namespace shvr

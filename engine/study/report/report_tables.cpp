#include "engine/study/report/report_tables.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "engine/base/error.h"
#include "engine/pages/html.h"
#include "engine/study/report/plots.h"
#include "engine/study/report/thesis_table.h"

namespace shvr {

namespace {

using enum Outcome;
constexpr Outcome TABLE_6_1[] = {dice_partial,    dice_full,      node_score, nodes_out,      nodes,
                                 internode_score, internodes_out, internodes, segments_found, topological_errors};

std::string cell(std::string_view words, const char* look = "")
{
    return sentence("<td", look, ">", report::escaped(words), "</td>");
}

std::string head(std::initializer_list<std::string_view> names)
{
    std::string markup = "<table><thead><tr>";
    for (const std::string_view name : names) markup += sentence("<th>", report::escaped(name), "</th>");
    return markup + "</tr></thead><tbody>\n";
}

constexpr const char* END = "</tbody></table>\n";

std::string with_interval(const Summary& summary)
{
    if (summary.count == 0) return "-";
    const std::string mean = short_digits(summary.mean);
    if (summary.count == 1) return mean;
    return mean + " [" + short_digits(summary.interval.low) + ", " + short_digits(summary.interval.high) + "]";
}

const OutcomeColumn& column_of(Outcome outcome)
{
    return outcome_columns()[size_t(outcome)];
}

std::string heading_of(Outcome outcome)
{
    const OutcomeColumn& column = column_of(outcome);
    return column.unit == "1" ? std::string(column.name) : sentence(column.name, ", ", column.unit);
}

/// Values of one outcome of one annotator at the centre, over its seeds; the outcome's own task has it.
Summary of_annotator(const StudyReport& report, uint32_t annotator, Outcome outcome)
{
    std::vector<double> values;
    for (const StudyRow& row : report.rows) {
        StudyCondition centre = report.centre;
        centre.task = row.condition.task;
        const bool is_painted = outcome == dice_partial || outcome == dice_full;
        const bool is_of_task = is_painted == (row.condition.task == StudyTask::paint);
        if (row.annotator == annotator && row.condition == centre && is_of_task) values.push_back(row[outcome]);
    }
    return summary_of(values);
}

/// A line of means, and one of standard deviations, of columns of values.
std::string mean_and_sd(const std::string& who, const std::map<Outcome, std::vector<double>>& columns)
{
    std::string means = "<tr class=\"sum\">" + cell(who + ", mean"), sds = "<tr class=\"sum\">" + cell(who + ", sd");
    for (const Outcome outcome : TABLE_6_1) {
        const auto found = columns.find(outcome);
        const Summary summary = summary_of(found == columns.end() ? std::vector<double>() : found->second);
        means += cell(short_digits(summary.mean));
        sds += cell(summary.count > 1 ? short_digits(summary.sd) : "-");
    }
    return means + "</tr>\n" + sds + "</tr>\n";
}

std::string thesis_part()
{
    std::string markup;
    std::map<Outcome, std::vector<double>> columns;
    for (const ThesisRow& row : thesis_rows()) {
        markup += "<tr>" + cell(row.participant == 0 ? "truth" : sentence("person ", row.participant));
        for (const Outcome outcome : TABLE_6_1) {
            const double value = row.value(outcome).value_or(NAN);
            markup += cell(short_digits(value));
            if (row.participant != 0) columns[outcome].push_back(value);
        }
        markup += "</tr>\n";
    }
    return markup + mean_and_sd("people", columns);
}

std::vector<Outcome> outcomes_of(const StudyReport& report, StudyTask task)
{
    std::vector<Outcome> outcomes;
    for (const OutcomeColumn& column : outcome_columns()) {
        const bool has_any = std::ranges::any_of(report.rows, [&](const StudyRow& row) {
            return row.condition.task == task && !std::isnan(row[column.outcome]);
        });
        if (has_any) outcomes.push_back(column.outcome);
    }
    return outcomes;
}

std::string verdict_of(const PairedDifference& paired, int better)
{
    if (paired.difference.count == 0) return "no pair";
    return paired.is_better(better) ? "better" : paired.is_worse(better) ? "worse" : "undecided";
}

std::string robustness_row(const std::string& hand, std::span<const StudyRow> rows, const StudyReport& report,
                           std::map<StudyTask, std::string>& at_centre)
{
    std::string markup = "<tr>" + cell(hand);
    for (const StudyTask task : {StudyTask::paint, StudyTask::trace}) {
        StudyCondition centre = report.centre;
        centre.task = task;
        const std::vector<StudyCondition> conditions = conditions_of(rows);
        const StudyCondition* const base = base_of(centre, conditions);
        const Outcome outcome = main_outcome(task);
        const PairedDifference paired = base ? paired_difference(rows, centre, *base, outcome) : PairedDifference{};
        const std::string verdict = verdict_of(paired, column_of(outcome).better);
        const bool is_first = at_centre.try_emplace(task, verdict).second;
        const bool differs = !is_first && verdict != at_centre[task];
        markup += cell(base ? with_interval(paired.difference) : "-");
        markup += cell(verdict + (differs ? ", differs" : ""), differs ? " class=\"bad\"" : "");
    }
    return markup + "</tr>\n";
}

}  // namespace

std::string thesis_table_of(const StudyReport& report)
{
    std::string markup = "<table><thead><tr><th>who</th>";
    for (const Outcome outcome : TABLE_6_1) markup += sentence("<th>", heading_of(outcome), "</th>");
    markup += "</tr></thead><tbody>\n" + thesis_part();
    std::set<uint32_t> annotators;
    for (const StudyRow& row : report.rows) {
        StudyCondition centre = report.centre;
        centre.task = row.condition.task;
        if (row.condition == centre) annotators.insert(row.annotator);
    }
    std::map<Outcome, std::vector<double>> columns;
    for (const uint32_t annotator : annotators) {
        markup += "<tr>" + cell(sentence("simulated ", annotator));
        for (const Outcome outcome : TABLE_6_1) {
            const Summary summary = of_annotator(report, annotator, outcome);
            markup += cell(short_digits(summary.mean));
            if (summary.count > 0) columns[outcome].push_back(summary.mean);
        }
        markup += "</tr>\n";
    }
    return markup + mean_and_sd("simulated", columns) + END;
}

std::string means_table_of(const StudyReport& report, StudyTask task)
{
    const std::vector<Outcome> outcomes = outcomes_of(report, task);
    std::string markup = "<div class=\"wide\"><table><thead><tr><th>condition</th><th>rows</th>";
    for (const Outcome outcome : outcomes) markup += sentence("<th>", heading_of(outcome), "</th>");
    markup += "</tr></thead><tbody>\n";
    for (const StudyCondition& condition : conditions_of(report.rows)) {
        if (condition.task != task) continue;
        const auto count = std::ranges::count(report.rows, condition, &StudyRow::condition);
        markup += "<tr>" + cell(words_of(condition)) + cell(sentence(count));
        for (const Outcome outcome : outcomes)
            markup += cell(with_interval(summary_of(values_of(report.rows, condition, outcome))));
        markup += "</tr>\n";
    }
    return markup + END + "</div>\n";
}

std::string worse_table_of(const StudyReport& report)
{
    const std::vector<StudyCondition> conditions = conditions_of(report.rows);
    std::string lines;
    for (const StudyCondition& condition : conditions) {
        const StudyCondition* const base = base_of(condition, conditions);
        if (condition.touch == StudyTouch::none || !base) continue;
        for (const Outcome outcome : outcomes_of(report, condition.task)) {
            const int better = column_of(outcome).better;
            const PairedDifference paired = paired_difference(report.rows, condition, *base, outcome);
            if (better == 0 || !paired.is_worse(better)) continue;
            lines += "<tr>" + cell(spelled(condition.task)) + cell(words_of(condition)) + cell(heading_of(outcome)) +
                     cell(with_interval(summary_of(values_of(report.rows, *base, outcome)))) +
                     cell(with_interval(summary_of(values_of(report.rows, condition, outcome)))) +
                     cell(with_interval(paired.difference), " class=\"bad\"") +
                     cell(sentence(paired.worse, " of ", paired.difference.count)) + "</tr>\n";
        }
    }
    if (lines.empty()) return "<p>No outcome of any condition is worse than without touch beyond its interval.</p>\n";
    return head({"task", "condition", "outcome", "without touch", "with it", "difference", "pairs that are worse"}) +
           lines + END;
}

std::string robustness_table_of(const StudyReport& report)
{
    if (report.variations.empty()) return "<p>Not run.</p>\n";
    std::string markup = head({"hand", "painting: difference", "answer", "tracing: difference", "answer"});
    std::map<StudyTask, std::string> at_centre;
    markup += robustness_row("as stated", report.rows, report, at_centre);
    for (const HandVariation& each : report.variations)
        markup +=
            robustness_row(sentence(each.parameter, " x ", short_digits(each.factor)), each.rows, report, at_centre);
    return markup + END;
}

std::string repeat_table_of(const StudyReport& report)
{
    if (report.repeats.empty()) return "<p>Not run.</p>\n";
    std::string markup = head(
        {"task", "condition", "runs", "pairs", "Dice score of both", "segment agreement", "distance of traces, voxel"});
    std::vector<StudyCondition> conditions;
    for (const StudyRepeat& each : report.repeats)
        if (std::ranges::find(conditions, each.condition) == conditions.end()) conditions.push_back(each.condition);
    for (const StudyCondition& condition : conditions)
        for (const bool is_within : {true, false}) {
            std::vector<double> dice, agreement, distance;
            for (const StudyRepeat& each : report.repeats) {
                if (each.condition != condition || each.is_within() != is_within) continue;
                dice.push_back(each.dice);
                agreement.push_back(each.segment_agreement);
                distance.push_back(each.distance_rms);
            }
            if (dice.empty()) continue;
            markup += "<tr>" + cell(spelled(condition.task)) + cell(words_of(condition)) +
                      cell(is_within ? "one annotator twice" : "two annotators") + cell(sentence(dice.size())) +
                      cell(with_interval(summary_of(dice))) + cell(with_interval(summary_of(agreement))) +
                      cell(with_interval(summary_of(distance))) + "</tr>\n";
        }
    return markup + END;
}

std::string baseline_table_of(const StudyReport& report)
{
    if (report.baselines.empty())
        return sentence("<p>", report::escaped(report.no_baselines.empty() ? "Not run." : report.no_baselines),
                        "</p>\n");
    std::string markup = "<table><thead><tr><th>method</th><th>noise, %</th><th>sections</th>";
    for (const Outcome outcome : TABLE_6_1) markup += sentence("<th>", heading_of(outcome), "</th>");
    markup += sentence("<th>", heading_of(centreline_rms), "</th></tr></thead><tbody>\n");
    std::vector<std::pair<std::string, double>> done;
    for (const BaselineRow& first : report.baselines) {
        const std::pair key(first.method, first.noise);
        if (std::ranges::find(done, key) != done.end()) continue;
        done.push_back(key);
        std::map<Outcome, std::vector<double>> columns;
        size_t sections = 0;
        std::string reason;
        for (const BaselineRow& row : report.baselines) {
            if (row.method != first.method || row.noise != first.noise) continue;
            if (!row.skipped.empty()) reason = row.skipped;
            sections += row.skipped.empty();
            for (const OutcomeColumn& column : outcome_columns())
                columns[column.outcome].push_back(row[column.outcome]);
        }
        markup += "<tr>" + cell(first.method);
        if (sections == 0) {
            markup += sentence("<td class=\"words\" colspan=\"", std::size(TABLE_6_1) + 3,
                               "\">skipped: ", report::escaped(reason), "</td></tr>\n");
            continue;
        }
        markup += cell(short_digits(first.noise)) + cell(sentence(sections));
        for (const Outcome outcome : TABLE_6_1) markup += cell(with_interval(summary_of(columns[outcome])));
        markup += cell(with_interval(summary_of(columns[centreline_rms]))) + "</tr>\n";
    }
    return markup + END;
}

std::string hand_table_of(const StudyReport& report)
{
    std::string markup = head({"parameter", "value", "unit", "source"});
    for (const HandParameter& each : report.hand)
        markup += "<tr>" + cell(each.name) + cell(each.value) + cell(each.unit) +
                  cell(each.source, " class=\"words\"") + "</tr>\n";
    return markup + END;
}

std::string codebook()
{
    std::string markup = head({"column", "unit", "better", "meaning"});
    for (const OutcomeColumn& column : outcome_columns())
        markup += "<tr>" + cell(column.name) + cell(column.unit) +
                  cell(column.better > 0   ? "more"
                       : column.better < 0 ? "less"
                                           : "-") +
                  cell(column.meaning, " class=\"words\"") + "</tr>\n";
    return markup + END;
}

std::string data_of(const StudyReport& report)
{
    std::string markup = head({"task", "condition", "rows", "seeds"});
    for (const StudyCondition& condition : conditions_of(report.rows)) {
        std::set<uint32_t> seeds;
        for (const StudyRow& row : report.rows)
            if (row.condition == condition) seeds.insert(row.seed);
        std::string listed;
        for (const uint32_t seed : seeds) listed += (listed.empty() ? "" : " ") + std::to_string(seed);
        const auto count = std::ranges::count(report.rows, condition, &StudyRow::condition);
        markup += "<tr>" + cell(spelled(condition.task)) + cell(words_of(condition)) + cell(sentence(count)) +
                  cell(listed, " class=\"words\"") + "</tr>\n";
    }
    markup += END;
    return markup + "<details><summary>All rows, as CSV</summary><pre>" + report::escaped(csv_of(report.rows)) +
           "</pre></details>\n";
}

}  // namespace shvr

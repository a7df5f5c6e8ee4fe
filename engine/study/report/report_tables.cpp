#include "engine/study/report/report_tables.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "engine/base/error.h"
#include "engine/pages/html.h"
#include "engine/study/report/cells.h"
#include "engine/study/report/plots.h"
#include "engine/study/report/thesis_table.h"

namespace shvr {

namespace {

using enum Outcome;
constexpr Outcome TABLE_6_1[] = {dice_partial,    dice_full,      node_score, nodes_out,      nodes,
                                 internode_score, internodes_out, internodes, segments_found, topological_errors};
constexpr Outcome TABLE_6_1_AND_DISTANCE[] = {dice_partial,   dice_full,          node_score,     nodes_out,
                                              nodes,          internode_score,    internodes_out, internodes,
                                              segments_found, topological_errors, centreline_rms};
/// Returns the task in which an outcome of table 6.1 is measured.
StudyTask task_of(Outcome outcome)
{
    return outcome == dice_partial || outcome == dice_full ? StudyTask::paint : StudyTask::trace;
}

/// Summarises an outcome of one annotator under the central condition, over all seeds, in the task that measures it.
Summary of_annotator(const StudyReport& report, uint32_t annotator, Outcome outcome)
{
    std::vector<double> values;
    for (const StudyRow& row : report.rows) {
        StudyCondition centre = report.centre;
        centre.task = row.condition.task;
        const bool is_of_task = row.condition.task == task_of(outcome);
        if (row.annotator == annotator && row.condition == centre && is_of_task) values.push_back(row[outcome]);
    }
    return summary_of(values);
}

/// Returns two table rows: the means and the standard deviations of the columns.
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

/// Returns rows to compare algorithms with: simulated annotators without touch and in the central condition; people.
std::string rows_of_hands(const StudyReport& report)
{
    std::string markup;
    const std::vector<StudyCondition> conditions = conditions_of(report.rows);
    const StudyCondition* const base = base_of(report.centre, conditions);
    for (StudyCondition condition : {base ? *base : report.centre, report.centre}) {
        if (condition == report.centre && !base) break;
        std::string values;
        size_t most = 0;
        for (const Outcome outcome : TABLE_6_1_AND_DISTANCE) {
            condition.task = task_of(outcome);
            const Summary summary = summary_of(values_of(report.rows, condition, outcome));
            most = std::max(most, summary.count);
            values += cell(with_interval(summary));
        }
        markup += "<tr class=\"sum\">" + cell("simulated, " + words_of(condition)) +
                  cell(short_digits(condition.noise)) + cell(sentence(most)) + values + "</tr>\n";
    }
    markup += "<tr class=\"sum\">" + cell("people of the thesis") + cell("-") + cell("1");
    for (const Outcome outcome : TABLE_6_1_AND_DISTANCE) {
        std::vector<double> people;
        for (const ThesisRow& row : thesis_rows())
            if (row.participant != 0) people.push_back(row.value(outcome).value_or(NAN));
        markup += cell(with_interval(summary_of(people)));
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
    return markup + rows_of_hands(report) + END;
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

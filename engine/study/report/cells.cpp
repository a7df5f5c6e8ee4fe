#include "engine/study/report/cells.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/pages/html.h"
#include "engine/study/report/plots.h"

namespace shvr {

std::string cell(std::string_view words, const char* look)
{
    return sentence("<td", look, ">", report::escaped(words), "</td>");
}

std::string head(std::initializer_list<std::string_view> names)
{
    std::string markup = "<table><thead><tr>";
    for (const std::string_view name : names) markup += sentence("<th>", report::escaped(name), "</th>");
    return markup + "</tr></thead><tbody>\n";
}

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

std::string main_outcome_in_words(StudyTask task)
{
    return task == StudyTask::paint ? "Dice score against the wanted bundles (dice_partial)"
                                    : "rms distance from the true axes in voxels (centreline_rms)";
}

std::string name_of(StudyTask task)
{
    return task == StudyTask::paint ? "Painting" : "Tracing";
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

StudyCondition centre_of(const StudyReport& report, StudyTask task)
{
    StudyCondition centre = report.centre;
    centre.task = task;
    return centre;
}

}  // namespace shvr

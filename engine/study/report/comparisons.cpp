#include "engine/study/report/comparisons.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <span>

#include "engine/base/error.h"
#include "engine/pages/html.h"
#include "engine/study/report/cells.h"
#include "engine/study/report/plots.h"
#include "engine/study/statistics.h"

namespace shvr {

namespace {

std::string verdict_of(const PairedDifference& paired, int better)
{
    if (paired.difference.count == 0) return "no pair";
    return paired.is_better(better) ? "better" : paired.is_worse(better) ? "worse" : "undecided";
}

/// The main outcome of a condition with touch, compared with that of its counterpart without touch.
struct MainComparison {
    StudyCondition condition;
    PairedDifference paired;
    std::string verdict;
};

std::optional<MainComparison> comparison_of(std::span<const StudyRow> rows, const StudyCondition& condition)
{
    const std::vector<StudyCondition> conditions = conditions_of(rows);
    const StudyCondition* const base = base_of(condition, conditions);
    if (condition.touch == StudyTouch::none || !base) return std::nullopt;
    const Outcome outcome = main_outcome(condition.task);
    const PairedDifference paired = paired_difference(rows, condition, *base, outcome);
    return MainComparison{condition, paired, verdict_of(paired, column_of(outcome).better)};
}

std::vector<MainComparison> comparisons_of(const StudyReport& report, StudyTask task)
{
    std::vector<MainComparison> comparisons;
    for (const StudyCondition& condition : conditions_of(report.rows))
        if (condition.task == task)
            if (const auto comparison = comparison_of(report.rows, condition)) comparisons.push_back(*comparison);
    return comparisons;
}

/// Compares the central condition, in pairs, with that condition without touch whose mean main outcome is best.
std::string best_free_hand(const StudyReport& report, StudyTask task)
{
    const Outcome outcome = main_outcome(task);
    const int sign = column_of(outcome).better;
    const StudyCondition centre = centre_of(report, task);
    std::optional<StudyCondition> best;
    double best_mean = 0.0;
    for (const StudyCondition& condition : conditions_of(report.rows)) {
        if (condition.task != task || condition.touch != StudyTouch::none || condition.noise != centre.noise) continue;
        const Summary summary = summary_of(values_of(report.rows, condition, outcome));
        if (summary.count == 0 || (best && (summary.mean - best_mean) * sign <= 0.0)) continue;
        best = condition;
        best_mean = summary.mean;
    }
    if (!best) return {};
    const PairedDifference paired = paired_difference(report.rows, centre, *best, outcome);
    if (paired.difference.count == 0) return {};
    const std::string verdict = verdict_of(paired, sign);
    return sentence("The best condition without touch at this noise is: ", words_of(*best), ", mean ",
                    short_digits(paired.before.mean), ". Touch (", words_of(centre), ") has ",
                    short_digits(paired.after.mean), " in the same ", paired.difference.count, " pairs; difference ",
                    with_interval(paired.difference), ", ", verdict, ".");
}

std::set<std::pair<uint32_t, uint32_t>> pairs_of(std::span<const HandVariation> variations)
{
    std::set<std::pair<uint32_t, uint32_t>> pairs;
    for (const HandVariation& each : variations)
        for (const StudyRow& row : each.rows) pairs.insert({row.annotator, row.seed});
    return pairs;
}

using Verdicts = std::map<StudyTask, std::string>;

/// Returns a row of the table. Marks verdicts that differ from `expected`; null: marks none.
std::string robustness_row(const std::string& hand, std::span<const StudyRow> rows, const StudyReport& report,
                           const Verdicts* expected, Verdicts& found)
{
    std::string markup = "<tr>" + cell(hand);
    for (const StudyTask task : REPORTED_TASKS) {
        const auto comparison = comparison_of(rows, centre_of(report, task));
        found[task] = comparison ? comparison->verdict : "no pair";
        const bool is_confirmed = !expected || found[task] == expected->at(task);
        const bool is_reversed = !is_confirmed && found[task] != "undecided" && expected->at(task) != "undecided";
        markup += cell(comparison ? sentence(comparison->paired.difference.count) : "-") +
                  cell(comparison ? with_interval(comparison->paired.difference) : "-") +
                  cell(found[task] + (is_reversed    ? ", reversed"
                                      : is_confirmed ? ""
                                                     : ", not confirmed"),
                       is_reversed ? " class=\"bad\"" : "");
    }
    return markup + "</tr>\n";
}

}  // namespace

std::string main_table_of(const StudyReport& report, StudyTask task)
{
    std::string lines;
    for (const MainComparison& each : comparisons_of(report, task)) {
        const PairedDifference& paired = each.paired;
        lines += "<tr>" + cell(words_of(each.condition)) + cell(sentence(paired.difference.count)) +
                 cell(with_interval(paired.before)) + cell(with_interval(paired.after)) +
                 cell(with_interval(paired.difference)) + cell(sentence(paired.better)) + cell(sentence(paired.worse)) +
                 cell(each.verdict, each.verdict == "worse" ? " class=\"bad\"" : "") + "</tr>\n";
    }
    if (lines.empty()) return {};
    return sentence("<p>", main_outcome_in_words(task), ", in pairs of the same annotator and phantom:</p>\n") +
           head({"condition", "pairs", "without touch", "with it", "difference", "better", "worse", "answer"}) + lines +
           END;
}

std::string limits_of(const StudyReport& report)
{
    std::string markup;
    for (const StudyTask task : REPORTED_TASKS) {
        std::string words;
        size_t too_few = 0;
        for (const MainComparison& each : comparisons_of(report, task)) {
            const size_t pairs = each.paired.difference.count;
            if (pairs > 0 && pairs < MIN_PAIRS)
                ++too_few;
            else if (each.condition == centre_of(report, task))
                words += sentence(" At the centre ", each.paired.worse, " of ", pairs, " pairs are worse.");
            else if (pairs > 0 && each.verdict != "better")
                words += sentence(" No gain with ", words_of(each.condition), ": difference ",
                                  with_interval(each.paired.difference), ", ", each.paired.worse, " of ", pairs,
                                  " pairs worse.");
        }
        if (too_few > 0)
            words += sentence(" ", too_few, too_few == 1 ? " condition has" : " conditions have", " fewer than ",
                              MIN_PAIRS, " pairs, too few for an answer: a larger study has more.");
        if (const std::string best = best_free_hand(report, task); !best.empty()) words += " " + best;
        if (!words.empty())
            markup += sentence("<p><strong>", name_of(task), "</strong>, ", main_outcome_in_words(task), ".",
                               report::escaped(words), "</p>\n");
    }
    return markup;
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
                     cell(with_interval(paired.before)) + cell(with_interval(paired.after)) +
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
    const std::set<std::pair<uint32_t, uint32_t>> pairs = pairs_of(report.variations);
    std::vector<StudyRow> same;
    for (const StudyRow& row : report.rows)
        if (pairs.contains({row.annotator, row.seed})) same.push_back(row);
    Verdicts stated, found;
    std::string lines = robustness_row("as stated, all pairs", report.rows, report, nullptr, stated);
    lines += robustness_row("as stated, the pairs of the lines below", same, report, &stated, found);
    std::map<StudyTask, std::map<std::string, size_t>> counts;
    for (const HandVariation& each : report.variations) {
        lines += robustness_row(sentence(each.parameter, " x ", short_digits(each.factor)), each.rows, report, &stated,
                                found);
        for (const StudyTask task : REPORTED_TASKS) ++counts[task][found[task]];
    }
    std::string words;
    for (const StudyTask task : REPORTED_TASKS)
        words += sentence(name_of(task), ", ", report.variations.size(), " changed hands: ", counts[task]["better"],
                          " better, ", counts[task]["undecided"], " undecided, ", counts[task]["worse"], " worse. ");
    return sentence("<p>", words, "</p>\n") +
           head({"hand", "painting: pairs", "difference", "answer", "tracing: pairs", "difference", "answer"}) + lines +
           END;
}

}  // namespace shvr

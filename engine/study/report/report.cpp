#include "engine/study/report/report.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/pages/html.h"
#include "engine/study/report/cells.h"
#include "engine/study/report/comparisons.h"
#include "engine/study/report/plots.h"
#include "engine/study/report/report_tables.h"
#include "engine/study/report/thesis_table.h"

namespace shvr {

namespace {

constexpr char STYLE[] = R"(.plot{display:block;margin:.6em 0}
.plot text{fill:var(--ink);font:12px sans-serif}.plot text.title{font-weight:bold}.plot text.faint{fill:var(--faint)}
.plot .grid{stroke:var(--line)}.plot .reference{stroke:var(--faint);stroke-dasharray:5 4}
.plot .box{fill:var(--field);stroke:var(--faint)}.plot .point{fill:var(--ink);fill-opacity:.35}
.plot .median{stroke:var(--ink);stroke-width:1.5}
.plot .mean{stroke:var(--link);fill:var(--link);stroke-width:3}
.plot .mean.good{stroke:var(--good);fill:var(--good)}.plot .mean.bad{stroke:var(--bad);fill:var(--bad)}
.plot path.mean{stroke-width:0}
.wide{overflow-x:auto}td{white-space:nowrap}td.words{text-align:left;white-space:normal;max-width:46em}
td.bad{color:var(--bad)}tr.sum td{font-weight:bold}
.note{border-left:4px solid var(--perhaps);padding:.1em 1em;max-width:62em}p{max-width:62em}
pre{overflow-x:auto;font-size:11px;background:var(--field);padding:.5em}
)";

std::string values_plot(const StudyReport& report, StudyTask task)
{
    const OutcomeColumn& column = column_of(main_outcome(task));
    IntervalPlot plot{.title = name_of(task) + (column.better > 0 ? " (more is better)" : " (less is better)"),
                      .axis = main_outcome_in_words(task),
                      .lines = {},
                      .reference = std::nullopt,
                      .reference_label = {}};
    for (const StudyCondition& condition : conditions_of(report.rows))
        if (condition.task == task)
            plot.lines.push_back({words_of(condition), values_of(report.rows, condition, column.outcome)});
    std::vector<double> people;
    for (const ThesisRow& row : thesis_rows())
        if (row.participant != 0)
            if (const std::optional<double> value = row.value(column.outcome)) people.push_back(*value);
    if (!people.empty()) {
        plot.reference = summary_of(people).mean;
        plot.reference_label = "people of the thesis, mean " + short_digits(*plot.reference);
    }
    return plot.lines.empty() ? std::string() : svg_of(plot);
}

std::vector<double> differences_of(const StudyReport& report, const StudyCondition& condition,
                                   const StudyCondition& base, Outcome outcome)
{
    std::vector<double> differences;
    for (const StudyRow& row : report.rows)
        for (const StudyRow& other : report.rows)
            if (row.condition == condition && other.condition == base && row.annotator == other.annotator &&
                row.seed == other.seed && !std::isnan(row[outcome] - other[outcome]))
                differences.push_back(row[outcome] - other[outcome]);
    return differences;
}

std::string differences_plot(const StudyReport& report, StudyTask task)
{
    const OutcomeColumn& column = column_of(main_outcome(task));
    const std::vector<StudyCondition> conditions = conditions_of(report.rows);
    IntervalPlot plot{.title = name_of(task) + ": difference from the same annotator and seed without touch",
                      .axis = "difference of the " + main_outcome_in_words(task),
                      .lines = {},
                      .reference = 0.0,
                      .reference_label = "no difference"};
    for (const StudyCondition& condition : conditions) {
        const StudyCondition* const base = base_of(condition, conditions);
        if (condition.task != task || condition.touch == StudyTouch::none || !base) continue;
        const PairedDifference paired = paired_difference(report.rows, condition, *base, column.outcome);
        const int tone = paired.is_better(column.better) ? 1 : paired.is_worse(column.better) ? -1 : 0;
        plot.lines.push_back({words_of(condition), differences_of(report, condition, *base, column.outcome), tone});
    }
    return plot.lines.empty() ? std::string() : svg_of(plot);
}

std::string beginning(const StudyReport& report)
{
    std::string claims;
    for (const StudyTask task : REPORTED_TASKS)
        if (const std::string claim = claim_of(report, task); !claim.empty())
            claims += sentence("<p><strong>", report::escaped(claim), "</strong></p>\n");
    return sentence(
        "<h1>Does touch help? The thesis's study, repeated by simulated annotators</h1>\n<p class=\"note\">No person "
        "took part. Every number of this page is from a model of a person, except where it says <em>person</em> or "
        "<em>people</em>.</p>\n",
        claims, "<p>Made by <code>", report::escaped(report.command), "</code>; this page by SHVR ",
        report::escaped(report.version),
        " from the rows in the folder. The same rows make the same page, byte for "
        "byte.</p>\n");
}

std::string method_of(const StudyReport& report)
{
    return sentence(
        "<h2>What was simulated, and what was not</h2>\n<p>", report::escaped(report.phantom), "</p>\n<p>",
        report::escaped(report.annotators), R"(</p>
<p>Not simulated: learning and tiredness, search for structures that an annotator does not know, the choice of modes and
views, opinions (the thesis's questionnaire), and whatever a model of a hand leaves out. A difference on this page is a
prediction about people, not an observation of them.</p>
<p>One factor at a time is varied around one centre: )",
        report::escaped(words_of(report.centre)),
        R"(. A ball of 1.5 radii: the radius of the probe, in mean radii of the phantom's veins. Surface: the force holds
the probe where bright voxels begin; proximity: it pulls the probe to the middle of the bright voxels in the ball;
object: likewise, of those alone that are connected to what the probe touched first. The main outcomes were named before any condition was compared: painting )",
        main_outcome_in_words(StudyTask::paint), ", tracing ", main_outcome_in_words(StudyTask::trace),
        R"(. All others are exploratory: no interval is corrected for their number, and one in twenty that excludes 0 does
so by chance.</p>
<p>Brackets are 95 % intervals of the mean, by the expanded percentile bootstrap ()",
        RESAMPLES, R"( resamples; Hesterberg, The American Statistician 69(4), 2015). Plots show each value as a point,
quartiles as a box with the median, the mean as a diamond and its interval as a bar; green is better than without touch,
red worse.</p>
)");
}

std::string results_of(const StudyReport& report)
{
    std::string markup;
    for (const StudyTask task : REPORTED_TASKS) {
        const std::string plot = values_plot(report, task);
        if (plot.empty()) continue;
        markup += sentence("<h2>", name_of(task), "</h2>\n", plot, differences_plot(report, task),
                           main_table_of(report, task), "<details><summary>All outcomes</summary>\n",
                           means_table_of(report, task), "</details>\n");
    }
    return markup;
}

}  // namespace

const StudyCondition* base_of(const StudyCondition& condition, const std::vector<StudyCondition>& conditions)
{
    const StudyCondition* base = nullptr;
    for (const StudyCondition& other : conditions) {
        const bool fits = other.task == condition.task && other.touch == StudyTouch::none &&
                          other.probe_radii == condition.probe_radii && other.noise == condition.noise;
        if (fits && (!base || other.law == condition.law)) base = &other;
    }
    return base;
}

std::string words_of(const StudyCondition& condition)
{
    const std::string law = condition.law == ProxyLaw::potential ? "default" : std::string(spelled(condition.law));
    const std::string touch = condition.touch == StudyTouch::none
                                  ? std::string("no touch")
                                  : sentence(spelled(condition.touch), ", ", law, " law");
    return sentence(touch, ", ball of ", digits_of(condition.probe_radii), " radii, noise ", digits_of(condition.noise),
                    " %");
}

std::string claim_of(const StudyReport& report, StudyTask task)
{
    const StudyCondition centre = centre_of(report, task);
    const std::vector<StudyCondition> conditions = conditions_of(report.rows);
    const StudyCondition* const base = base_of(centre, conditions);
    if (!base) return {};
    const int better = column_of(main_outcome(task)).better;
    const PairedDifference paired = paired_difference(report.rows, centre, *base, main_outcome(task));
    if (paired.difference.count == 0) return {};
    const std::string few = sentence("cannot be judged from fewer than ", MIN_PAIRS, " pairs of");
    const std::string verdict = paired.difference.count < MIN_PAIRS ? few
                                : paired.is_better(better)          ? "helps"
                                : paired.is_worse(better)           ? "harms"
                                                                    : "makes no difference that this study can see for";
    return sentence(name_of(task), ": touch (", words_of(centre), ") ", verdict, " simulated annotators; mean ",
                    main_outcome_in_words(task), ' ', short_digits(paired.before.mean), " without it, ",
                    short_digits(paired.after.mean), " with it; difference ", short_digits(paired.difference.mean),
                    " [", short_digits(paired.difference.interval.low), ", ",
                    short_digits(paired.difference.interval.high), "] in ", paired.difference.count, " pairs, ",
                    paired.better, " better and ", paired.worse, " worse.");
}

std::string page_of(const StudyReport& report)
{
    std::string body = beginning(report) + method_of(report) + results_of(report);
    const auto section = [&](const char* title, const std::string& words, const std::string& markup) {
        body += sentence("<h2>", title, "</h2>\n", words.empty() ? "" : "<p>" + words + "</p>\n", markup);
    };
    section("Where touch makes results worse, or no better",
            "Results that are not better with touch, first of the main outcomes, then all outcomes whose difference "
            "from the same annotators and phantoms without touch lies, with its whole interval, on the worse side.",
            limits_of(report) + worse_table_of(report));
    section("Next to the thesis", sentence(THESIS_SOURCE, " Simulated annotators had the centre's mode throughout."),
            "<div class=\"wide\">" + thesis_table_of(report) + "</div>\n");
    section("Does the answer depend on the modelled hand?",
            "The central comparison, with each parameter of the hand halved and doubled. The answer is better or worse "
            "where the interval of the difference excludes 0, else undecided; fewer pairs have wider intervals. "
            "Reversed: better turned into worse, or worse into better. Not "
            "confirmed: undecided here only.",
            robustness_table_of(report));
    section("Repeatability", "", repeat_table_of(report));
    section("Without a hand",
            "Algorithms that a user would pick (tools/study/baselines.py), above simulated annotators and people. They "
            "do not "
            "know which bundles are wanted, and take no one's ten minutes.",
            "<div class=\"wide\">" + baseline_table_of(report) + "</div>\n");
    section("The modelled hand", "", hand_table_of(report));
    section("Columns", "", codebook());
    section("Seeds and rows", "", data_of(report));
    return report::page("SHVR: study with simulated annotators", STYLE, body);
}

}  // namespace shvr

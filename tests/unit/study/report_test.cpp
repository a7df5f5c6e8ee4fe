// The report of a study: what it says for rows whose answer is known, and that the page is whole.

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "engine/pages/html.h"
#include "engine/study/report/comparisons.h"
#include "engine/study/report/plots.h"
#include "engine/study/report/report.h"
#include "engine/study/report/report_tables.h"
#include "engine/study/report/thesis_table.h"
#include "engine/study/statistics.h"
#include "engine/volume/split_mix.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using shvr::test::TemporaryFolder;

namespace {

/// Painting: object following scores 0.03 more than no touch, surface sampling 0.02 less. Tracing: object following is
/// 2.5 voxels nearer, and costs 20 s. Seeds shift all of them alike.
void add_rows(uint32_t seed, std::vector<StudyRow>& rows)
{
    SplitMix64 random(seed);
    const double shift = double(random.below(1000)) / 1000.0;
    for (const StudyTask task : {StudyTask::paint, StudyTask::trace})
        for (const StudyTouch touch : {StudyTouch::none, StudyTouch::object, StudyTouch::surface}) {
            StudyRow row{
                .condition = {.task = task, .touch = touch}, .annotator = 1 + seed % 10, .seed = seed, .values = {}};
            row.values.fill(NAN);
            const auto set = [&](Outcome outcome, double value) { row.values[size_t(outcome)] = value; };
            const bool is_object = touch == StudyTouch::object;
            const double noise = double(random.below(1000)) * 1e-5;
            set(Outcome::seconds, 300.0 + (is_object ? 20.0 : 0.0) + noise);
            if (task == StudyTask::paint) {
                set(Outcome::dice_partial, 0.9 + 0.03 * shift + noise +
                                               (is_object                      ? 0.03
                                                : touch == StudyTouch::surface ? -0.02
                                                                               : 0.0));
                set(Outcome::dice_full, 0.8);
            } else {
                set(Outcome::centreline_rms, 5.0 + shift + noise - (is_object ? 2.5 : 0.0));
                set(Outcome::node_score, 0.95);
            }
            rows.push_back(row);
        }
}

StudyReport a_report()
{
    StudyReport report{.command = "shvr study -o \"<b>\"",
                       .version = "1",
                       .phantom = "A section.",
                       .annotators = "They follow <a> plan.",
                       .centre = {.touch = StudyTouch::object},
                       .rows = {},
                       .hand = {{"wandering", "1.5", "mm", "somebody & others <2001>"}},
                       .variations = {},
                       .repeats = {},
                       .baselines = {},
                       .no_baselines = {}};
    for (uint32_t seed = 1; seed <= 30; ++seed) add_rows(seed, report.rows);
    // With twice the tremor, touch makes tracing worse.
    HandVariation turned{.parameter = "tremor", .factor = 2.0, .rows = report.rows};
    for (StudyRow& row : turned.rows)
        if (row.condition.touch == StudyTouch::object) row.values[size_t(Outcome::centreline_rms)] += 5.0;
    report.variations = {{"tremor", 0.5, report.rows}, turned};
    for (uint32_t seed = 1; seed <= 5; ++seed)
        report.repeats.push_back({.condition = report.centre,
                                  .annotator = 1,
                                  .other = seed % 2 + 1,
                                  .seed = seed,
                                  .dice = NAN,
                                  .segment_agreement = 0.9,
                                  .distance_rms = 1.25});
    return report;
}

size_t count_of(const std::string& part, const std::string& text)
{
    size_t count = 0;
    for (size_t at = text.find(part); at != text.npos; at = text.find(part, at + part.size())) ++count;
    return count;
}

/// Why the markup's tags do not nest; empty if they do.
std::string fault_of(const std::string& page)
{
    std::vector<std::string> open;
    for (size_t at = page.find('<'); at != page.npos; at = page.find('<', at + 1)) {
        const size_t end = page.find('>', at);
        if (end == page.npos) return "a tag without end";
        const std::string tag = page.substr(at + 1, end - at - 1);
        const std::string name = tag.substr(0, tag.find_first_of(" \n"));
        if (name == "!DOCTYPE" || name == "meta" || tag.back() == '/') continue;
        if (name[0] != '/') {
            open.push_back(name);
        } else {
            if (open.empty() || open.back() != name.substr(1))
                return name + " closes " + (open.empty() ? "" : open.back());
            open.pop_back();
        }
    }
    return open.empty() ? "" : open.back() + " stays open";
}

std::string refusal_of(const std::string& text)
{
    const TemporaryFolder folder;
    try {
        read_baselines(folder.write("b.csv", text));
    } catch (const std::exception& error) {
        return error.what();
    }
    return {};
}

}  // namespace

TEST_CASE("table 6.1 has the means and deviations that the thesis and its readers state")
{
    std::array<std::vector<double>, OUTCOMES> columns;
    for (const ThesisRow& row : thesis_rows())
        for (size_t i = 0; i < OUTCOMES; ++i)
            if (row.participant != 0) columns[i].push_back(row.value(Outcome(i)).value_or(NAN));
    const auto summary = [&](Outcome outcome) { return summary_of(columns[size_t(outcome)]); };
    REQUIRE(columns[0].size() == 10);
    const auto near = [](double value, double expected) { return std::abs(value - expected) < 0.0006; };
    CHECK(near(summary(Outcome::dice_partial).mean, .941));
    CHECK(near(summary(Outcome::dice_full).mean, .817));
    CHECK(near(summary(Outcome::node_score).mean, .946));
    CHECK(near(summary(Outcome::internode_score).mean, .965));
    CHECK(near(summary(Outcome::segments_found).mean, 18.5));
    CHECK(near(summary(Outcome::topological_errors).mean, 0.7));
    CHECK(near(summary(Outcome::dice_partial).sd, .051));
    CHECK(near(summary(Outcome::dice_full).sd, .023));
    CHECK(near(summary(Outcome::node_score).sd, .035));
    CHECK(near(summary(Outcome::internode_score).sd, .034));
    CHECK(std::abs(summary(Outcome::segments_found).sd - 5.95) < 0.005);
    CHECK(std::abs(summary(Outcome::topological_errors).sd - 1.25) < 0.005);
    CHECK(std::abs(summary(Outcome::dice_partial).median - .968) < 1e-9);
    CHECK(summary(Outcome::nodes).mean == 51.5);
    CHECK(summary(Outcome::internodes).mean == 49.5);
    CHECK(summary(Outcome::nodes_out).mean == 1.7);
    CHECK(summary(Outcome::internodes_out).mean == 1.5);
    CHECK(summary(Outcome::centreline_rms).count == 0);

    // The thesis's means of "out" are those of ten shares, not the shares of all nodes (17/515) and all internodes.
    double nodes = 0.0, internodes = 0.0;
    for (const ThesisRow& row : thesis_rows().subspan(1)) {
        nodes += 0.1 * row.nodes_out / row.nodes;
        internodes += 0.1 * row.internodes_out / row.internodes;
    }
    CHECK(near(nodes, .029));
    CHECK(near(internodes, .031));
}

TEST_CASE("each row of table 6.1 holds what the thesis prints")
{
    const std::vector<std::string> printed = {
        "1.000 0.824 0.971 0/70 1.000 0/71 26/26 0",    "2 0.883 0.770 0.969 0/32 0.914 2/29 11/26 0",
        "3 0.862 0.819 0.916 3/63 0.967 1/63 26/26 0",  "5 0.907 0.841 0.938 3/57 1.000 0/54 17/26 0",
        "6 0.966 0.841 0.974 1/73 1.000 0/72 23/26 0",  "7 0.988 0.814 0.977 0/46 0.995 0/46 14/26 0",
        "8 0.991 0.817 0.959 1/43 0.987 0/38 11/26 0",  "9 0.970 0.803 0.918 2/46 0.968 2/48 26/26 1",
        "10 0.881 0.847 0.977 0/53 0.941 3/47 19/26 4", "11 0.975 0.806 0.964 0/35 0.966 1/35 14/26 1",
        "12 0.986 0.812 0.871 7/67 0.909 6/63 24/26 1"};
    std::vector<std::string> held;
    for (const ThesisRow& row : thesis_rows()) {
        std::array<char, 80> line{};
        std::snprintf(line.data(), line.size(), "%.3f %.3f %.3f %d/%d %.3f %d/%d %d/%.0f %d", row.dice_partial,
                      row.dice_full, row.node_score, row.nodes_out, row.nodes, row.internode_score, row.internodes_out,
                      row.internodes, row.segments_found, row.value(Outcome::segments_total).value_or(0.0),
                      row.topological_errors);
        held.push_back((row.participant == 0 ? "" : std::to_string(row.participant) + ' ') + line.data());
    }
    CHECK(held == printed);
}

TEST_CASE("a report states the answer, its interval, and where touch makes results worse")
{
    const StudyReport report = a_report();
    const std::string painting = claim_of(report, StudyTask::paint), tracing = claim_of(report, StudyTask::trace);
    CHECK(painting.find("helps simulated annotators; mean Dice score") != std::string::npos);
    CHECK(painting.find("30 pairs, 30 better and 0 worse") != std::string::npos);
    CHECK(tracing.find("in voxels (centreline_rms)") != std::string::npos);
    CHECK(tracing.find("difference -2.50 [-2.50, -2.50]") != std::string::npos);

    const std::string worse = worse_table_of(report);
    CHECK(count_of("<tr>", worse) == 4);  // heading; painting by surface; time of object, in both tasks
    CHECK(count_of("surface, default law", worse) == 1);
    CHECK(count_of("seconds, s", worse) == 2);
    CHECK(worse.find("30 of 30") != std::string::npos);

    const std::string robust = robustness_table_of(report);
    CHECK(count_of("worse, reversed", robust) == 1);
    CHECK(count_of(">better<", robust) == 7);
    CHECK(robust.find("Tracing, 2 changed hands: 1 better, 0 undecided, 1 worse.") != std::string::npos);
    const std::string repeats = repeat_table_of(report);
    CHECK(count_of("one annotator twice", repeats) == 1);
    CHECK(count_of(">two annotators<", repeats) == 1);
}

/// Keeps the rows of the first seeds for which `drops` holds.
template <class Drops>
void keep_seeds(uint32_t seeds, std::vector<StudyRow>& rows, Drops&& drops)
{
    std::erase_if(rows, [&](const StudyRow& row) { return row.seed > seeds && drops(row); });
}

// Kind (Study): conditions with fewer pairs than the free hand that they are compared with
TEST_CASE("means next to a difference are of its pairs, not of all rows")
{
    StudyReport report = a_report();
    keep_seeds(5, report.rows, [](const StudyRow& row) { return row.condition.touch == StudyTouch::surface; });
    // Later seeds paint worse by 0.4 without touch: in all rows the mean is far from that of the five pairs.
    for (StudyRow& row : report.rows)
        if (row.seed > 5 && row.condition.touch == StudyTouch::none) row.values[size_t(Outcome::dice_partial)] -= 0.4;
    const StudyCondition surface{.task = StudyTask::paint, .touch = StudyTouch::surface};
    const StudyCondition none{.task = StudyTask::paint, .touch = StudyTouch::none};
    const PairedDifference paired = paired_difference(report.rows, surface, none, Outcome::dice_partial);
    CHECK(paired.difference.count == 5);
    CHECK(paired.before.count == 5);
    CHECK(std::abs(paired.after.mean - paired.before.mean - paired.difference.mean) < 1e-12);
    CHECK(std::abs(summary_of(values_of(report.rows, none, Outcome::dice_partial)).mean - paired.before.mean) > 0.2);
    CHECK(worse_table_of(report).find("<td>" + short_digits(paired.before.mean) + " [") != std::string::npos);
    CHECK(main_table_of(report, StudyTask::paint).find("<td>" + short_digits(paired.before.mean) + " [") !=
          std::string::npos);
}

TEST_CASE("a report names conditions that do not help, and a free hand that is as good")
{
    StudyReport report = a_report();
    // A larger ball without touch paints as well as touch does at the centre.
    for (const StudyRow& row : std::vector(report.rows)) {
        if (row.condition != StudyCondition{.task = StudyTask::paint, .touch = StudyTouch::object}) continue;
        StudyRow free = row;
        free.condition.touch = StudyTouch::none;
        free.condition.probe_radii = 2.5;
        free.values[size_t(Outcome::dice_partial)] += row.seed % 2 ? 0.001 : -0.001;
        report.rows.push_back(free);
    }
    const std::string limits = limits_of(report);
    CHECK(limits.find("At the centre 0 of 30 pairs are worse.") != std::string::npos);
    CHECK(limits.find("No gain with surface, default law, ball of 1.5 radii, noise 10 %: difference -0.0") !=
          std::string::npos);
    CHECK(limits.find("without touch at this noise is: no touch, ball of 2.5 radii") != std::string::npos);
    CHECK(limits.find(", undecided.") != std::string::npos);
    CHECK(page_of(report).find(limits) != std::string::npos);
}

TEST_CASE("hands of fewer seeds are shown next to the stated hand in the same pairs")
{
    StudyReport report = a_report();
    for (HandVariation& each : report.variations) keep_seeds(5, each.rows, [](const StudyRow&) { return true; });
    const std::string robust = robustness_table_of(report);
    CHECK(count_of("<td>as stated", robust) == 2);
    CHECK(count_of("<td>30</td>", robust) == 2);
    CHECK(count_of("<td>5</td>", robust) == 6);
}

TEST_CASE("a page is whole, holds everything itself, and says what it is of")
{
    StudyReport report = a_report();
    const TemporaryFolder folder;
    report.baselines = read_baselines(
        folder.write("b.csv",
                     "seed,method,noise,skipped,dice_partial\n1,flood,10,,0.5\n2,flood,10,,0.7\n,\"<sato>, new\",,\"no "
                     "\"\"scipy\"\"\",\n"));
    const std::string page = page_of(report);
    CHECK(fault_of(page) == "");
    CHECK(page == page_of(report));
    CHECK(page.find("No person took part.") != std::string::npos);
    CHECK(page.find("prefers-color-scheme:dark") != std::string::npos);
    CHECK(count_of("<svg", page) == 4);
    for (const char* const outside : {" src=", "href=", "url(", "@import", "<script"})
        CHECK(count_of(outside, page) == 0);
    CHECK(count_of("http", page) == 4);  // the name of SVG
    CHECK(page.find("shvr study -o &quot;&lt;b&gt;&quot;") != std::string::npos);
    CHECK(page.find("somebody &amp; others &lt;2001&gt;") != std::string::npos);
    CHECK(page.find("&lt;sato&gt;, new") != std::string::npos);
    CHECK(page.find("skipped: no &quot;scipy&quot;") != std::string::npos);
    CHECK(page.find("0.600 [") != std::string::npos);  // the mean of both sections
    CHECK(page.find("They follow &lt;a&gt; plan.") != std::string::npos);
    CHECK(page.find("people of the thesis, mean 0.941") != std::string::npos);
    CHECK(count_of("<td>person ", page) == 10);
    CHECK(count_of("<td>simulated ", page) == 10);
    for (const OutcomeColumn& column : outcome_columns())
        CHECK(page.find("<td>" + std::string(column.name) + "</td>") != std::string::npos);
    // Every row is in the page.
    CHECK(page.find(report::escaped(csv_of(report.rows))) != std::string::npos);
    if (const char* const kept = std::getenv("SHVR_KEEP_STUDY_PAGE")) report::write_text(kept, page);
}

// Kind (Study): a report without rows, of one row, of one seed
TEST_CASE("reports of few rows are pages, too, and claim nothing")
{
    StudyReport report = a_report();
    const std::vector<StudyRow> all = report.rows;
    report.variations.clear();
    report.repeats.clear();
    for (const size_t rows : {0u, 1u, 6u}) {
        report.rows.assign(all.begin(), all.begin() + ptrdiff_t(rows));
        const std::string page = page_of(report);
        CHECK(fault_of(page) == "");
        CHECK(count_of("helps", page) == 0);
        CHECK(page.find("nan") == std::string::npos);
    }
    CHECK(claim_of(report, StudyTask::trace).find("cannot be judged from fewer than 5 pairs") != std::string::npos);
    // Three pairs that all are better.
    report.rows = all;
    keep_seeds(3, report.rows, [](const StudyRow&) { return true; });
    CHECK(count_of("helps", page_of(report)) == 0);
    CHECK(count_of("No gain", limits_of(report)) == 0);
    CHECK(limits_of(report).find("fewer than 5 pairs, too few for an answer") != std::string::npos);
}

TEST_CASE("a condition is compared with no touch at the same noise and ball")
{
    const StudyCondition none{.touch = StudyTouch::none}, of_thesis{.touch = StudyTouch::none, .law = ProxyLaw::thesis},
        noisy{.touch = StudyTouch::none, .noise = 20.0};
    const std::vector<StudyCondition> conditions{none, of_thesis, noisy};
    CHECK(base_of({.touch = StudyTouch::object}, conditions) == &conditions[0]);
    CHECK(base_of({.touch = StudyTouch::object, .law = ProxyLaw::mean}, conditions) == &conditions[0]);
    CHECK(base_of({.touch = StudyTouch::object, .law = ProxyLaw::thesis}, conditions) == &conditions[1]);
    CHECK(base_of({.touch = StudyTouch::object, .noise = 20.0}, conditions) == &conditions[2]);
    CHECK(base_of({.touch = StudyTouch::object, .probe_radii = 2.5}, conditions) == nullptr);
    CHECK(base_of({.task = StudyTask::paint}, conditions) == nullptr);
}

TEST_CASE("ticks are round, few, and cover the values")
{
    for (const auto& [low, high] : {std::pair(0.0, 1.0),
                                    {0.87, 0.993},
                                    {-2.5, 0.0},
                                    {0.0, 612.0},
                                    {3.0, 3.0},
                                    {-1e-9, 1e-9},
                                    {0.0, 0.0},
                                    {0.8, 12.0},
                                    {-11.0, 6.3},
                                    {0.0, 1.01}}) {
        const std::vector<double> ticks = ticks_of(low, high);
        CAPTURE(low);
        CHECK(ticks.size() >= 2);
        CHECK(ticks.size() <= 9);
        CHECK(ticks.back() - ticks.front() <= std::max(2.0 * (high - low), 0.002));  // no plot that is mostly empty
        CHECK(ticks.front() <= low + 1e-12);
        CHECK(ticks.back() >= high - 1e-12);
    }
    CHECK(short_digits(0.94123) == "0.941");
    CHECK(short_digits(-0.0001) == "0");
    CHECK(short_digits(51.53) == "51.5");
    CHECK(short_digits(26.0) == "26");
    CHECK(short_digits(-0.0) == "0");
    CHECK(short_digits(612.4) == "612");
    CHECK(short_digits(NAN) == "-");
}

// Kind (Study): baselines in files that are broken
TEST_CASE("broken files of baselines are refused by line and column")
{
    const std::string head = "method,noise,seed,skipped,dice_partial\n";
    CHECK(refusal_of(head + "flood,10,1,,0.5\n") == "");
    CHECK(refusal_of("method,seed\n").find("line 1 has no column noise") != std::string::npos);
    CHECK(refusal_of("").find("line 1 has no column method") != std::string::npos);
    CHECK(refusal_of(head + "flood,10,1\n").find("line 2 has 3 fields, not 5") != std::string::npos);
    CHECK(refusal_of(head + "flood,10,1,,high\n").find("column \"dice_partial\": \"high\" is not a finite number") !=
          std::string::npos);
    CHECK(refusal_of(head + "flood,10,1.5,,\n").find("\"1.5\" is not a whole number") != std::string::npos);
    CHECK(refusal_of(head + "flood,10,-1,,\n").find("is not a whole number") != std::string::npos);
    CHECK(refusal_of(head + "flood,1e999,1,,\n").find("column \"noise\"") != std::string::npos);
    CHECK(refusal_of(head + ",10,1,,\n").find("column method: is empty") != std::string::npos);
}

// A study's rows as a CSV file: written and read back, and files that are broken.

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "engine/base/error.h"
#include "engine/study/repeats.h"
#include "engine/study/rows.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using shvr::test::TemporaryFolder;

namespace {

StudyRow a_row()
{
    StudyRow row{
        .condition = {.task = StudyTask::paint, .touch = StudyTouch::none, .law = ProxyLaw::thesis, .probe_radii = 0.1},
        .annotator = 3,
        .seed = 4294967295u,
        .values = {}};
    row.values.fill(std::numeric_limits<double>::quiet_NaN());
    row.values[size_t(Outcome::dice_partial)] = 0.1 + 0.2;
    row.values[size_t(Outcome::force_most)] = 1e-300;
    return row;
}

std::string failure_of(const std::string& text)
{
    const TemporaryFolder folder;
    try {
        read_study_rows(folder.write("rows.csv", text));
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

}  // namespace

TEST_CASE("rows of a study read back as the same bits")
{
    const TemporaryFolder folder;
    const StudyRow rows[] = {a_row(), {.condition = {}, .annotator = 1, .seed = 2, .values = {}}};
    const std::vector<StudyRow> read = read_study_rows(folder.write("rows.csv", csv_of(rows)));
    REQUIRE(read.size() == 2);
    for (size_t i = 0; i < 2; ++i) {
        CHECK(read[i].condition == rows[i].condition);
        CHECK(read[i].annotator == rows[i].annotator);
        CHECK(read[i].seed == rows[i].seed);
        for (size_t v = 0; v < OUTCOMES; ++v)
            CHECK((std::isnan(rows[i].values[v]) ? std::isnan(read[i].values[v])
                                                 : read[i].values[v] == rows[i].values[v]));
    }
}

TEST_CASE("columns of outcomes are in the order of the enumeration, with different names")
{
    for (size_t i = 0; i < OUTCOMES; ++i) {
        CHECK(size_t(outcome_columns()[i].outcome) == i);
        for (size_t k = 0; k < i; ++k) CHECK(outcome_columns()[i].name != outcome_columns()[k].name);
    }
}

TEST_CASE("broken rows are refused with line, column and value")
{
    const StudyRow row = a_row();
    const std::string good = csv_of({&row, 1});
    CHECK(failure_of(good) == "");
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        return text.replace(text.rfind(from), from.size(), to);
    };
    CHECK(failure_of("a,b\n").find("line 1 is \"a,b\", not the header") != std::string::npos);
    CHECK(failure_of(with("paint,", "draw,")).find("line 2, column task: \"draw\" is not one of paint trace") !=
          std::string::npos);
    CHECK(failure_of(with(",3,", ",-3,")).find("column annotator: \"-3\" is not a whole number") != std::string::npos);
    CHECK(failure_of(with("1e-300", "inf")).find("column force_most: \"inf\" is not a finite number") !=
          std::string::npos);
    CHECK(failure_of(with(",3,", ",")).find("line 2 has 27 fields, not 28") != std::string::npos);
    CHECK(failure_of("").find("line 1 is \"\"") != std::string::npos);
}

// Kind (Study): repeats in a file that is broken, or of another study
TEST_CASE("repeats of a study read back as the same bits, and broken ones are refused by line and column")
{
    const TemporaryFolder folder;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const StudyRepeat repeats[] = {{.condition = a_row().condition,
                                    .annotator = 3,
                                    .other = 4,
                                    .seed = 7,
                                    .dice = 0.1 + 0.2,
                                    .segment_agreement = nan,
                                    .distance_rms = nan},
                                   {.condition = {},
                                    .annotator = 1,
                                    .other = 1,
                                    .seed = 1,
                                    .dice = nan,
                                    .segment_agreement = 1e-300,
                                    .distance_rms = 20.73841936846918}};
    const std::string csv = csv_of(repeats);
    const std::vector<StudyRepeat> read = read_study_repeats(folder.write("repeats.csv", csv));
    REQUIRE(read.size() == 2);
    CHECK(read[0].condition == repeats[0].condition);
    CHECK(read[0].dice == 0.1 + 0.2);
    CHECK(std::isnan(read[0].distance_rms));
    CHECK(read[1].distance_rms == 20.73841936846918);
    CHECK(csv_of(read) == csv);

    const auto refusal = [&](const std::string& text) {
        try {
            read_study_repeats(folder.write("broken.csv", text));
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    const std::string head = csv.substr(0, csv.find('\n') + 1);
    CHECK(refusal(head + "trace,none,potential,1.5,10,1,1,1,,0.5\n").find("line 2 has 10 fields, not 11") !=
          std::string::npos);
    CHECK(refusal(head + "trace,none,potential,1.5,10,1,one,1,,0.5,2\n").find("column other: \"one\" is not") !=
          std::string::npos);
    CHECK(refusal("task,touch\n").find("line 1 is") != std::string::npos);
}

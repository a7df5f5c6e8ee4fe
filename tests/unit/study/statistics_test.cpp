// Statistics of a study: closed forms, known streams of the generator, and intervals that hold the truth as often as
// they say.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include "engine/study/statistics.h"
#include "engine/volume/split_mix.h"
#include "tests/support/slow.h"

using namespace shvr;

namespace {

constexpr double NOT_KNOWN = std::numeric_limits<double>::quiet_NaN();

StudyRow row_of(StudyTouch touch, uint32_t seed, double rms, double dice = NOT_KNOWN)
{
    StudyRow row{.condition = {.touch = touch}, .annotator = 1, .seed = seed, .values = {}};
    row.values.fill(NOT_KNOWN);
    row.values[size_t(Outcome::centreline_rms)] = rms;
    row.values[size_t(Outcome::dice_partial)] = dice;
    return row;
}

/// The sum of twelve uniform numbers minus six: nearly normal, mean 0, variance 1.
double nearly_normal(SplitMix64& random)
{
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += double(random.next() >> 11) * 0x1p-53;
    return sum;
}

/// How often the interval of `count` values holds the mean they were drawn with.
double coverage(size_t count, int samples, double (*draw)(SplitMix64&), double mean)
{
    SplitMix64 random(count);
    int held = 0;
    std::vector<double> values(count);
    for (int i = 0; i < samples; ++i) {
        for (double& value : values) value = draw(random);
        held += interval_of_mean(values, uint64_t(i)).holds(mean);
    }
    return double(held) / samples;
}

}  // namespace

TEST_CASE("the generator gives the published stream of SplitMix64")
{
    // The reference implementation's first numbers for the seed 1234567.
    SplitMix64 random(1234567);
    for (const uint64_t expected : {6457827717110365317ull, 3203168211198807973ull, 9817491932198370423ull,
                                    4593380528125082431ull, 16408922859458223821ull})
        CHECK(random.next() == expected);
    std::array<int, 7> counts{};
    for (int i = 0; i < 7000; ++i) ++counts[random.below(7)];
    for (const int count : counts) CHECK(std::abs(count - 1000) < 150);  // five standard deviations
}

TEST_CASE("summaries have the closed forms of their definitions")
{
    std::vector<double> values(11);
    std::iota(values.begin(), values.end(), 0.0);
    std::ranges::reverse(values);
    values.insert(values.begin() + 3, NOT_KNOWN);
    const Summary summary = summary_of(values);
    CHECK(summary.count == 11);
    CHECK(summary.mean == 5.0);
    CHECK(summary.sd == doctest::Approx(std::sqrt(11.0)));  // n (n + 1) / 12
    CHECK(summary.least == 0.0);
    CHECK(summary.lower_quartile == 2.5);
    CHECK(summary.median == 5.0);
    CHECK(summary.upper_quartile == 7.5);
    CHECK(summary.most == 10.0);
    CHECK(summary.interval.holds(5.0));
    CHECK(quantile_of(std::array{1.0, 2.0}, 0.25) == 1.25);
}

// Kind (Study): statistics of no value, of one, of equal ones
TEST_CASE("few values have a summary without invented spread")
{
    const Summary none = summary_of({});
    CHECK(none.count == 0);
    for (const double value : {none.mean, none.sd, none.median, none.interval.low}) CHECK(std::isnan(value));
    const Summary one = summary_of(std::array{3.5});
    CHECK(one.mean == 3.5);
    CHECK(one.sd == 0.0);
    CHECK(one.interval.low == 3.5);
    CHECK(one.interval.high == 3.5);
    const Summary equal = summary_of(std::vector<double>(30, 0.1));
    CHECK(equal.sd < 1e-15);
    CHECK(equal.interval.low == doctest::Approx(0.1));
    // Two values: the interval reaches to both.
    const Interval two = interval_of_mean(std::array{1.0, 2.0});
    CHECK(two.low == 1.0);
    CHECK(two.high == 2.0);
}

TEST_CASE("intervals have the same bits on every machine")
{
    const std::array values{0.93, 0.88, 0.97, 0.91, 0.99, 0.85, 0.95, 0.90};
    const Interval interval = interval_of_mean(values, 7), again = interval_of_mean(values, 7);
    CHECK(std::bit_cast<uint64_t>(interval.low) == std::bit_cast<uint64_t>(again.low));
    // As a second program in Python computes them.
    CHECK(interval.low == 0x1.c51eb851eb851p-1);
    CHECK(interval.high == 0x1.eb851eb851eb9p-1);
}

TEST_CASE("an interval is as wide as Student's for many values of a symmetric distribution")
{
    std::vector<double> values(40);
    for (size_t i = 0; i < 40; ++i) values[i] = double(i);
    const Summary summary = summary_of(values);
    const double student = 2.0227 * summary.sd / std::sqrt(40.0);
    CHECK(summary.interval.high - summary.mean == doctest::Approx(student).epsilon(0.03));
    CHECK(summary.mean - summary.interval.low == doctest::Approx(student).epsilon(0.03));
}

TEST_CASE("intervals hold the mean in about 95 of 100 samples")
{
    // Everyday: 300 samples of ten, standard deviation 1.3 %; slow: 2000 samples, 0.5 %, of each size and shape.
    const int samples = test::is_slow() ? 2000 : 300;
    CHECK(std::abs(coverage(10, samples, nearly_normal, 0.0) - 0.95) < (test::is_slow() ? 0.02 : 0.045));
    if (!test::is_slow()) return;
    CHECK(std::abs(coverage(30, samples, nearly_normal, 0.0) - 0.95) < 0.02);
    // Skewed, like squares of errors: the mean of the square of a normal number is 1. Less is known to be held there.
    const auto skewed = [](SplitMix64& random) {
        const double value = nearly_normal(random);
        return value * value;
    };
    CHECK(coverage(30, samples, skewed, 1.0) > 0.90);
}

// Kind (Study): pairs of which one half is missing
TEST_CASE("differences are between rows of the same annotator and seed")
{
    const StudyCondition none{.touch = StudyTouch::none}, object{.touch = StudyTouch::object};
    std::vector<StudyRow> rows;
    for (uint32_t seed = 1; seed <= 20; ++seed) {
        rows.push_back(row_of(StudyTouch::none, seed, 5.0 + seed, 0.5));
        rows.push_back(row_of(StudyTouch::object, seed, 3.0 + seed + 0.1 * (seed % 2), seed == 1 ? 0.4 : 0.5));
    }
    rows.push_back(row_of(StudyTouch::object, 99, 1000.0));   // no partner
    rows.push_back(row_of(StudyTouch::none, 98, NOT_KNOWN));  // no value
    rows.push_back(row_of(StudyTouch::object, 98, 1000.0));
    rows.push_back(row_of(StudyTouch::proximity, 1, 1000.0));

    const PairedDifference rms = paired_difference(rows, object, none, Outcome::centreline_rms);
    CHECK(rms.difference.count == 20);
    CHECK(rms.difference.mean == doctest::Approx(-1.95));
    CHECK((rms.better == 20 && rms.worse == 0 && rms.equal == 0));
    CHECK(rms.is_better(-1));
    CHECK_FALSE(rms.is_worse(-1));
    CHECK(rms.difference.interval.high < -1.9);
    // The spread of the seeds, sd 5.9, is not in the differences.
    CHECK(rms.difference.sd < 0.06);

    const PairedDifference dice = paired_difference(rows, object, none, Outcome::dice_partial);
    CHECK((dice.better == 0 && dice.worse == 1 && dice.equal == 19));
    CHECK_FALSE(dice.is_worse(1));  // the interval reaches 0
    CHECK(conditions_of(rows).size() == 3);
    CHECK(values_of(rows, none, Outcome::centreline_rms).size() == 20);
}

#include "engine/ranks/row_plan.h"

#include <algorithm>

#include <doctest/doctest.h>

using namespace shvr;

namespace {

std::vector<RowStrip> strips_of(RowPlan& plan, int rank)
{
    std::vector<RowStrip> strips;
    while (const std::optional<RowStrip> strip = plan.next(rank)) strips.push_back(*strip);
    CHECK_FALSE(plan.peek(rank).has_value());
    return strips;
}

std::vector<RowStrip> all_strips(RowPlan plan, int ranks)
{
    std::vector<RowStrip> all;
    for (int rank = 0; rank < ranks; ++rank)
        for (const RowStrip& strip : strips_of(plan, rank)) all.push_back(strip);
    std::ranges::sort(all, {}, &RowStrip::lower);
    return all;
}

}  // namespace

TEST_CASE("strips cover all rows once")
{
    for (const int64_t rows : {1, 2, 16, 5000})
        for (const int ranks : {1, 2, 7, 4096})
            for (const int64_t at_once : {int64_t{1}, int64_t{5}, rows})
                for (const std::vector<double>& work :
                     {std::vector<double>{}, {0.0, 0.0}, {1.0}, {0.0, 5.0, 1e12, 0.0, 3.0}}) {
                    int64_t next = 0;
                    for (const RowStrip& strip : all_strips({rows, work, ranks, at_once}, ranks)) {
                        const bool follows = strip.lower == next && strip.upper > strip.lower;
                        REQUIRE(follows);
                        REQUIRE(strip.upper - strip.lower <= at_once);
                        next = strip.upper;
                    }
                    REQUIRE(next == rows);
                }
}

TEST_CASE("each rank has one strip of a round, in the order of ranks")
{
    RowPlan plan(1000, {}, 4, 400);
    CHECK(strips_of(plan, 0) == std::vector<RowStrip>{{0, 100}, {400, 500}, {800, 850}});
    CHECK(strips_of(plan, 3) == std::vector<RowStrip>{{300, 400}, {700, 800}, {950, 1000}});
}

TEST_CASE("strips have equal counted work")
{
    // Nine tenths of the work is in the second quarter.
    const std::vector<double> work{1.0, 27.0, 1.0, 1.0};
    constexpr int RANKS = 8;
    RowPlan plan(1000, work, RANKS, 1000);
    for (int rank = 0; rank < RANKS; ++rank) {
        const std::vector<RowStrip> strips = strips_of(plan, rank);
        REQUIRE(strips.size() == 1);
        double sum = 0.0;
        for (int64_t row = strips[0].lower; row < strips[0].upper; ++row) sum += work[size_t(row) * 4 / 1000];
        // A row counts a little beyond its counted work, and strips end at whole rows.
        CHECK(sum == doctest::Approx(7500.0 / RANKS).epsilon(0.08));
    }
}

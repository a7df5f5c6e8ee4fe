// How far the medians of equal work lie apart by chance, tried with random times.

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "tools/report/noise.h"

using namespace shvr;

namespace {

struct Times {
    double minimum, median, p95;
};

/// Sums up times as profiles and the bench do.
Times times_of(size_t count, const std::function<double()>& draw)
{
    std::vector<double> values(count);
    std::generate(values.begin(), values.end(), draw);
    std::sort(values.begin(), values.end());
    return {values.front(), (values[(count - 1) / 2] + values[count / 2]) / 2.0,
            values[size_t(std::ceil(0.95 * double(count))) - 1]};
}

/// The share of pairs that differ by more than their noise, where the second takes `longer` more.
double share_beyond(size_t count, const std::function<double()>& draw, double longer, int pairs)
{
    int beyond = 0;
    for (int i = 0; i < pairs; ++i) {
        const Times a = times_of(count, draw), b = times_of(count, draw);
        const std::optional<double> noise =
            report::noise_of_both(report::noise_of(a.minimum, a.p95, count), report::noise_of(b.minimum, b.p95, count));
        REQUIRE(noise.has_value());
        beyond += std::abs(b.median + longer - a.median) > *noise ? 1 : 0;
    }
    return double(beyond) / pairs;
}

}  // namespace

TEST_CASE("of pairs of equal work about one in a thousand differs by more than its noise, however few its times are")
{
    std::mt19937 random(7);
    std::normal_distribution<double> normal(10.0, 1.0);
    std::exponential_distribution<double> late(1.0);
    for (const bool is_normal : {true, false})
        for (const size_t count : {3u, 4u, 5u, 6u, 7u, 8u, 9u, 12u, 20u}) {
            CAPTURE(is_normal);
            CAPTURE(count);
            const auto draw = [&] { return is_normal ? normal(random) : 10.0 + late(random); };
            CHECK(share_beyond(count, draw, 0.0, 20'000) < 0.002);
            // And no noise is so wide that work of twice the time is the same.
            CHECK(share_beyond(count, draw, 10.0, 1'000) > (count == 3 ? 0.6 : 0.95));
        }
}

TEST_CASE("two times tell no noise")
{
    CHECK(!report::noise_of(1.0, 2.0, 0));
    CHECK(!report::noise_of(1.0, 2.0, 2));
    CHECK(report::noise_of(1.0, 2.0, 20) == 0.5);
    CHECK(!report::noise_of_both(0.5, std::nullopt));
    CHECK(report::noise_of_both(3.0, 4.0) == 5.0);
}

// Steps between two densities, against the integral in thousands of parts.

#include "engine/look/preintegration.h"
#include "tests/support/bounds.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <doctest/doctest.h>

using namespace shvr;

namespace {

constexpr uint32_t SIDE = 64;
const glm::dvec3 RED{1.0, 0.25, 0.0}, BLUE{0.0, 0.5, 1.0};

glm::dvec4 entry(const std::vector<glm::vec4>& table, uint32_t front, uint32_t back, uint32_t side = SIDE)
{
    return glm::dvec4(table[size_t(back) * side + front]);
}

/// Light and opacity of a step, in parts with constant values.
glm::dvec4 summed(const TransferFunction& function, double step, double front, double back, int parts)
{
    glm::dvec3 light(0.0);
    double through = 1.0;
    for (int part = 0; part < parts; ++part) {
        const glm::dvec4 here = function.at(front + (back - front) * (part + 0.5) / parts);
        const double opacity = opacity_of_step(here.a, step / parts);
        light += through * opacity * glm::dvec3(here);
        through *= 1.0 - opacity;
    }
    return glm::dvec4(light, 1.0 - through);
}

std::vector<glm::vec4> looks_of(const TransferFunction& function, double step)
{
    return preintegrated_table(function, step, whole_range(function, SIDE)).looks;
}

std::vector<uint32_t> visible_of(const TransferFunction& function, const std::vector<glm::vec4>& table)
{
    return visible_intervals_of_steps(table, whole_range(function, SIDE), opaque_intervals(function));
}

double density_of(const TransferFunction& function, uint32_t at)
{
    return function.lower() + (function.upper() - function.lower()) * at / (SIDE - 1);
}

}  // namespace

TEST_CASE("where nothing changes, every entry is the plain step")
{
    for (const double opacity : {0.0, 1e-9, 0.01, 0.5, 0.999, 1.0 - 1e-12})
        for (const double step : {0.01, 0.5, 1.0}) {
            const TransferFunction function({{10.0, RED, opacity}, {200.0, RED, opacity}});
            const double expected = opacity_of_step(opacity, step);
            for (const glm::vec4& look : looks_of(function, step)) {
                REQUIRE(look.a == doctest::Approx(expected).epsilon(1e-6));
                REQUIRE(look.r == doctest::Approx(expected).epsilon(1e-6));
                REQUIRE(look.g == doctest::Approx(0.25 * expected).epsilon(1e-6));
            }
        }
}

TEST_CASE("entries are the integral between their densities")
{
    std::mt19937 random(5);  // seed 5
    const auto unit = [&] { return double(random()) / 4294967296.0; };
    for (int trial = 0; trial < 60; ++trial) {
        CAPTURE(trial);
        std::vector<ControlPoint> points;
        double intensity = -20.0;
        for (int i = 0; i < 2 + int(random() % 5); ++i) {
            points.push_back({intensity, {unit(), unit(), unit()}, random() % 3 == 0 ? 0.0 : unit()});
            if (random() % 4 == 0) points.push_back({intensity, {unit(), unit(), unit()}, unit()});  // a step
            intensity += random() % 2 == 0 ? 50.0 * unit() : 0.3;
        }
        const TransferFunction function(points);
        const double step = 0.1 + 0.9 * unit();
        const std::vector<glm::vec4> table = looks_of(function, step);
        for (int pair = 0; pair < 20; ++pair) {
            const auto front = uint32_t(random() % SIDE), back = uint32_t(random() % SIDE);
            if (front == back) continue;
            CAPTURE(front);
            CAPTURE(back);
            const glm::dvec4 expected =
                summed(function, step, density_of(function, front), density_of(function, back), 20000);
            const glm::dvec4 seen = entry(table, front, back);
            test::check_below("opacity", std::abs(seen.a - expected.a),
                              2e-4);  // the error of 20000 parts at a step of the function
            for (int channel = 0; channel < 3; ++channel)
                test::check_below("colour", std::abs(seen[channel] - expected[channel]), 5e-3);
            CHECK(entry(table, back, front).a == doctest::Approx(seen.a).epsilon(1e-6));
        }
    }
}

TEST_CASE("the diagonal is the function itself")
{
    const TransferFunction function({{0.0, RED, 0.1}, {63.0, BLUE, 0.7}});
    const std::vector<glm::vec4> table = looks_of(function, 0.5);
    for (uint32_t at = 0; at < SIDE; ++at) {
        const glm::dvec4 here = function.at(at);
        const double opacity = opacity_of_step(here.a, 0.5);
        CHECK(entry(table, at, at).a == doctest::Approx(opacity).epsilon(1e-6));
        CHECK(entry(table, at, at).r == doctest::Approx(opacity * here.r).epsilon(1e-6));
    }
}

TEST_CASE("a peak between two entries is not lost")
{
    // 0.02 wide, where entries are 1 apart. Its extinction in closed form: the mean of -ln(1 - o), o from 0 to 0.9, is
    // 1 + ln(0.1) / 9.
    const double mean = 1.0 + 0.1 * std::log(0.1) / 0.9;
    const TransferFunction peak(
        {{0.0, RED, 0.0}, {20.49, RED, 0.0}, {20.5, RED, 0.9}, {20.51, RED, 0.0}, {63.0, RED, 0.0}});
    const std::vector<glm::vec4> table = looks_of(peak, 0.5);
    for (const uint32_t back : {21u, 22u, 40u, 63u}) {
        const double expected = -std::expm1(-0.5 * mean * 0.02 / (back - 20.0));
        CHECK(entry(table, 20, back).a == doctest::Approx(expected).epsilon(1e-5));
        CHECK(entry(table, back, 20).a == doctest::Approx(expected).epsilon(1e-5));
    }
    CHECK(entry(table, 0, 20) == glm::dvec4(0.0));
    CHECK(entry(table, 21, 63) == glm::dvec4(0.0));
    CHECK(visible_of(peak, table).at(20) == 0);
    CHECK(visible_of(peak, table).at(21) == 1);
    CHECK(visible_of(peak, table).at(63) == 1);
}

TEST_CASE("densities at which rays end are told apart from the table, and visible")
{
    const TransferFunction wall(
        {{0.0, RED, 0.0}, {30.2, RED, 0.0}, {30.2, BLUE, 1.0}, {30.6, RED, 1.0}, {30.6, RED, 0.0}, {63.0, RED, 0.0}});
    const std::vector<glm::vec4> table = looks_of(wall, 0.5);
    CHECK(entry(table, 0, 63) == glm::dvec4(0.0));
    const std::vector<uint32_t> visible = visible_of(wall, table);
    CHECK(visible.at(30) == 0);
    CHECK(visible.at(31) == 1);
    CHECK(visible.at(63) == 1);
    const std::vector<OpaqueInterval> found = opaque_intervals(wall);
    REQUIRE(found.size() == 1);
    CHECK(found[0].lower == 30.2);
    CHECK(found[0].upper == 30.6);
    CHECK(found[0].lower_color == BLUE);
    CHECK(found[0].upper_color == RED);
}

TEST_CASE("rays end at peaks up to 1 and at plateaus of 1, and not at steps up to 1 that fall at once")
{
    const auto intervals = [](std::vector<ControlPoint> points) {
        std::vector<std::pair<double, double>> found;
        for (const OpaqueInterval& interval : opaque_intervals(TransferFunction(std::move(points))))
            found.emplace_back(interval.lower, interval.upper);
        return found;
    };
    using Pairs = std::vector<std::pair<double, double>>;
    CHECK(intervals({{0.0, RED, 0.0}, {5.0, RED, 1.0}, {9.0, RED, 0.0}}) == Pairs{{5.0, 5.0}});
    CHECK(intervals({{0.0, RED, 0.0}, {9.0, RED, 1.0}}) == Pairs{{9.0, 9.0}});
    CHECK(intervals({{0.0, RED, 1.0}, {9.0, RED, 0.0}}) == Pairs{{0.0, 0.0}});
    CHECK(intervals({{0.0, RED, 0.0}, {5.0, RED, 1.0}, {5.0, RED, 0.0}, {9.0, RED, 0.0}}) == Pairs{});
    CHECK(intervals({{0.0, RED, 0.0}, {5.0, RED, 0.2}, {5.0, RED, 1.0}, {9.0, RED, 0.0}}) == Pairs{{5.0, 5.0}});
    CHECK(intervals({{1.0, RED, 1.0}, {5.0, RED, 1.0}, {7.0, RED, 1.0}, {9.0, RED, 0.0}}).back().second == 7.0);
}

TEST_CASE("what is in front is seen first")
{
    const TransferFunction function({{0.0, RED, 0.9}, {31.5, RED, 0.9}, {31.5, BLUE, 0.9}, {63.0, BLUE, 0.9}});
    const std::vector<glm::vec4> table = looks_of(function, 1.0);
    CHECK(entry(table, 0, 63).r > 2.0 * entry(table, 0, 63).b);
    CHECK(entry(table, 63, 0).b > 2.0 * entry(table, 63, 0).r);
}

TEST_CASE("a function that draws nothing is a table of nothing")
{
    for (const std::vector<ControlPoint>& points : {std::vector<ControlPoint>{},
                                                    {{5.0, RED, 1.0}},
                                                    {{5.0, RED, 1.0}, {5.0, RED, 1.0}},
                                                    {{0.0, RED, 0.0}, {9.0, RED, 0.0}}}) {
        const std::vector<glm::vec4> table = looks_of(TransferFunction(points), 0.5);
        CHECK(std::ranges::all_of(table, [](const glm::vec4& look) { return look == glm::vec4(0.0f); }));
        CHECK(visible_of(TransferFunction(points), table).back() == 0);
    }
}

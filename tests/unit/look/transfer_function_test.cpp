#include "engine/look/transfer_function.h"

#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "tests/support/bounds.h"

using namespace shvr;

namespace {

ControlPoint grey(double intensity, double shade, double opacity)
{
    return {intensity, glm::dvec3(shade), opacity};
}

/// Opacities of a table, colours left white.
std::vector<glm::vec4> table_of(const std::vector<float>& opacities)
{
    std::vector<glm::vec4> table;
    for (const float opacity : opacities) table.emplace_back(1.0f, 1.0f, 1.0f, opacity);
    return table;
}

void check_against_counting(const std::vector<glm::vec4>& table)
{
    const std::vector<uint32_t> visible = visible_intervals(table);
    REQUIRE(visible.size() == table.size());
    for (size_t first = 0; first + 1 < table.size(); ++first) {
        uint32_t count = 0;
        for (size_t last = first; last + 1 < table.size(); ++last) {
            if (table[last].a > 0.0f || table[last + 1].a > 0.0f) ++count;
            REQUIRE(visible[last + 1] - visible[first] == count);
        }
    }
}

}  // namespace

TEST_CASE("n steps of 1/n reference lengths compose to the opacity of one")
{
    for (const double opacity : {0.01, 0.5, 0.99}) {
        for (int steps = 4; steps <= 16384; steps *= 2) {
            CAPTURE(opacity);
            CAPTURE(steps);
            const double step_opacity = opacity_of_step(opacity, 1.0 / steps);
            double composed = 0.0;
            for (int step = 0; step < steps; ++step) composed += (1.0 - composed) * step_opacity;
            test::check_below("composed", std::abs(composed - opacity), 1e-12);
            test::check_below("there and back", std::abs(opacity_of_step(step_opacity, steps) - opacity), 1e-12);
        }
    }
}

TEST_CASE("the opacity of a step is exact where it is 0, 1, or as long as the reference")
{
    for (const double step : {0.0, 1e-9, 0.5, 1.0, 64.0}) CHECK(opacity_of_step(0.0, step) == 0.0);
    for (const double step : {1e-9, 0.5, 1.0, 64.0}) CHECK(opacity_of_step(1.0, step) == 1.0);
    CHECK(opacity_of_step(1.0, 0.0) == 0.0);
    for (const double opacity : {1e-12, 0.01, 0.5, 0.99}) {
        CAPTURE(opacity);
        test::check_below("relative", std::abs(opacity_of_step(opacity, 1.0) / opacity - 1.0), 1e-14);
    }
    // pow() would return 0 here.
    test::check_below("relative", std::abs(opacity_of_step(1e-18, 0.5) / 5e-19 - 1.0), 1e-14);
}

TEST_CASE("values are linear between points, equal to the points on them, and exactly 0 outside")
{
    const TransferFunction function({grey(200, 1.0, 0.8), grey(-100, 0.0, 0.2), grey(100, 0.5, 0.0)});
    CHECK(function.lower() == -100.0);
    CHECK(function.upper() == 200.0);
    CHECK(function.at(-100) == glm::dvec4(0.0, 0.0, 0.0, 0.2));
    CHECK(function.at(0) == glm::dvec4(0.25, 0.25, 0.25, 0.1));
    CHECK(function.at(100) == glm::dvec4(0.5, 0.5, 0.5, 0.0));
    CHECK(function.at(150) == glm::dvec4(0.75, 0.75, 0.75, 0.4));
    CHECK(function.at(200) == glm::dvec4(1.0, 1.0, 1.0, 0.8));
    const double infinity = std::numeric_limits<double>::infinity();
    for (const double outside : {std::nextafter(-100.0, -infinity), std::nextafter(200.0, infinity), -infinity,
                                 infinity, std::numeric_limits<double>::quiet_NaN()}) {
        CAPTURE(outside);
        const glm::dvec4 found = function.at(outside);
        test::check_below("seen of what is outside", found.r + found.g + found.b + found.a, 0.0);
    }
}

TEST_CASE("points at one intensity make a step whose last point holds at the intensity itself")
{
    const TransferFunction function(
        {grey(10, 0.1, 0.1), grey(0, 0.0, 0.0), grey(10, 0.9, 0.9), grey(10, 0.4, 0.4), grey(20, 0.4, 0.4)});
    CHECK(function.at(10).a == 0.4);
    CHECK(function.at(std::nextafter(10.0, 0.0)).a == doctest::Approx(0.1).epsilon(1e-12));
    CHECK(function.at(std::nextafter(10.0, 20.0)).a == 0.4);
    CHECK(function.points()[1].opacity == 0.1);
    CHECK(function.points()[2].opacity == 0.9);
    CHECK(function.points()[3].opacity == 0.4);

    const TransferFunction box({grey(5, 1, 0), grey(5, 1, 1), grey(6, 1, 1), grey(6, 1, 0)});
    CHECK(box.at(5).a == 1.0);
    CHECK(box.at(std::nextafter(6.0, 0.0)).a == 1.0);
    CHECK(box.at(6).a == 0.0);
}

TEST_CASE("nothing is drawn with fewer than two points, without width or without opacity")
{
    CHECK(TransferFunction().draws_nothing());
    CHECK(TransferFunction().at(0) == glm::dvec4(0.0));
    const TransferFunction one({grey(7, 1, 1)});
    CHECK(one.draws_nothing());
    CHECK(one.at(7) == glm::dvec4(0.0));
    const TransferFunction narrow({grey(7, 1, 1), grey(7, 1, 1)});
    CHECK(narrow.draws_nothing());
    CHECK(narrow.at(7) == glm::dvec4(0.0));
    CHECK(TransferFunction({grey(0, 1, 0), grey(9, 1, 0)}).draws_nothing());
    CHECK_FALSE(TransferFunction({grey(0, 1, 0), grey(9, 1, 1e-30)}).draws_nothing());
    for (const glm::vec4& entry : bake_table(one, 0.5, whole_range(one, 16)).looks) CHECK(entry == glm::vec4(0.0f));
}

TEST_CASE("numbers that are not finite or out of range are refused by name")
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double infinity = std::numeric_limits<double>::infinity();
    for (const double bad : {nan, infinity, -infinity, 1e39}) {
        CAPTURE(bad);
        CHECK_THROWS_AS(TransferFunction({grey(0, 0, 0), grey(bad, 0, 0)}), Error);
    }
    for (const double bad : {nan, infinity, -infinity, -1e-9, std::nextafter(1.0, 2.0)}) {
        CAPTURE(bad);
        CHECK_THROWS_AS(TransferFunction({grey(0, 0, bad)}), Error);
        CHECK_THROWS_AS(TransferFunction({{0.0, {0.0, bad, 0.0}, 0.5}}), Error);
    }
    CHECK_THROWS_WITH(TransferFunction({grey(0, 0, 0), grey(1, 0, 1.5)}),
                      "transfer function: opacity of point 1 is 1.5; expected 0 to 1");
}

TEST_CASE("4096 points are found exactly")
{
    std::vector<ControlPoint> points;
    for (int index = 0; index < 4096; ++index) points.push_back(grey(index, 0.5, (index * 37 % 101) / 101.0));
    const TransferFunction function(points);
    for (const ControlPoint& point : points) {
        CAPTURE(point.intensity);
        test::check_below("opacity at a point", std::abs(function.at(point.intensity).a - point.opacity), 0.0);
    }
}

TEST_CASE("a table starts and ends on the function's ends and holds corrected opacities")
{
    const TransferFunction function({grey(-3.7, 0.25, 0.1), grey(91.3, 0.75, 1.0)});
    const std::vector<glm::vec4> table = bake_table(function, 0.25, whole_range(function, 1000)).looks;
    REQUIRE(table.size() == 1000);
    CHECK(table.front() == glm::vec4(0.25f, 0.25f, 0.25f, float(opacity_of_step(0.1, 0.25))));
    CHECK(table.back() == glm::vec4(0.75f, 0.75f, 0.75f, 1.0f));
    for (uint32_t entry = 0; entry < 1000; ++entry) {
        const double exact = opacity_of_step(0.1 + 0.9 * entry / 999.0, 0.25);
        CAPTURE(entry);
        test::check_below("opacity of a table's entry, relative", std::abs(double(table[entry].a) / exact - 1.0), 1e-7);
    }
}

TEST_CASE("a table with an entry for each whole intensity samples exactly there")
{
    const TransferFunction function(
        {grey(0, 1, 0), grey(137, 1, 0), grey(137, 1, 0.5), grey(138, 1, 0), grey(255, 1, 0)});
    const std::vector<glm::vec4> table = bake_table(function, 1.0, whole_range(function, 256)).looks;
    for (size_t entry = 0; entry < 256; ++entry) CHECK((table[entry].a > 0.0f) == (entry == 137));
    CHECK(table[137].a == doctest::Approx(0.5).epsilon(1e-7));
}

TEST_CASE("visible intervals agree with counting, spikes at every place included")
{
    for (size_t spike = 0; spike < 9; ++spike) {
        std::vector<float> opacities(9, 0.0f);
        opacities[spike] = 1e-38f;
        check_against_counting(table_of(opacities));
    }
    check_against_counting(table_of(std::vector<float>(9, 0.0f)));
    check_against_counting(table_of(std::vector<float>(9, 1.0f)));
    std::mt19937 random(5);
    for (int round = 0; round < 100; ++round) {
        std::vector<float> opacities(2 + random() % 60);
        const auto rarity = 1 + random() % 10;
        for (float& opacity : opacities) opacity = random() % rarity == 0 ? 0.5f : 0.0f;
        check_against_counting(table_of(opacities));
    }
    CHECK(visible_intervals({}).empty());
    CHECK(visible_intervals(table_of({1.0f})) == std::vector<uint32_t>{0});
    CHECK(visible_intervals(table_of({0.0f, 0.0f, 1.0f, 0.0f, 0.0f})) == std::vector<uint32_t>{0, 0, 1, 2, 2});
}

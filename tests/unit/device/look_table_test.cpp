// The number and positions of entries in a transfer function's table.

#include "engine/device/look_table.h"
#include "tests/support/bounds.h"

#include <cmath>

#include <doctest/doctest.h>

using namespace shvr;

namespace {

const IntensityWindow BYTES{.lower = 0.0, .codes_per_unit = 257.0};
const IntensityWindow WORDS{.lower = 0.0, .codes_per_unit = 1.0};

TransferFunction greys(const std::vector<std::pair<double, double>>& points)
{
    std::vector<ControlPoint> all;
    for (const auto& [intensity, opacity] : points) all.push_back({intensity, glm::dvec3(opacity), opacity});
    return TransferFunction(all);
}

/// The largest difference between the table, linear between entries, and the function, at whole codes.
double worst_at_codes(const TransferFunction& function, const IntensityWindow& window)
{
    const TableRange range = table_range(function, window, false);
    const LookTable table = make_look_table(function, window, 1.0, false);
    const double scale = (range.samples.entries - 1) / (range.upper - range.lower);
    double worst = 0.0;
    for (double code = std::ceil(range.lower); code <= range.upper; code += 1.0) {
        const double at = (code - range.lower) * scale;
        const auto entry = std::min(size_t(at), size_t(range.samples.entries - 2));
        const double share = at - double(entry);
        const double seen = (1.0 - share) * table.texels[entry].a + share * table.texels[entry + 1].a;
        worst = std::max(worst, std::abs(seen - function.at(window.intensity_of(code)).a));
    }
    return worst;
}

}  // namespace

TEST_CASE("at every code the table is the function, with few entries where few are enough")
{
    struct Case {
        TransferFunction function;
        IntensityWindow window;
        uint32_t most;
    };
    const Case cases[] = {
        {greys({{22.4609, 0.0}, {250.0, 0.9}}), BYTES, 4096},
        {greys({{20.0, 0.0}, {97.0, 0.3}, {180.0, 0.1}, {255.0, 0.9}}), BYTES, 4351},
        {greys({{0.0, 0.0}, {16384.0, 0.3}, {65535.0, 0.9}}), WORDS, 65536},
        {greys({{0.0, 0.0}, {1000.0, 0.3}, {4000.0, 0.2}, {64000.0, 0.9}}), WORDS, 4161},
        {greys({{0.0, 0.0}, {31000.0, 0.0}, {31000.0, 0.6}, {65535.0, 0.6}}), WORDS, 65536},
        {greys({{-1e9, 0.0}, {31000.0, 0.0}, {31000.0, 0.6}, {1e9, 0.6}}), WORDS, 65536},
        {greys({{20.0, 0.0}, {97.0, 0.3}, {255.0, 1.0}}), BYTES, 65536},
        {greys({{3.0, 0.5}, {3.3, 0.0}, {3.9, 0.6}, {4.0, 0.1}}), BYTES, 4113},
    };
    for (const Case& one : cases) {
        CAPTURE(one.most);
        CHECK(table_range(one.function, one.window, false).samples.entries <= one.most);
        test::check_below("opacity at codes", worst_at_codes(one.function, one.window), 2e-6);
    }
}

TEST_CASE("a table covers the codes that there are, and no others")
{
    const TableRange wide = table_range(greys({{-1e30, 0.5}, {1e30, 0.5}}), BYTES, false);
    CHECK(wide.lower == 0.0);
    CHECK(wide.upper == 65535.0);
    CHECK(wide.samples.lower == 0.0);
    CHECK(wide.samples.upper == 255.0);
    for (const auto& [from, to] : {std::pair(300.0, 400.0), {-9.0, -5.0}}) {
        const LookTable outside = make_look_table(greys({{from, 0.5}, {to, 0.5}}), BYTES, 0.5, false);
        CHECK(outside.visible_intervals.back() == 0);
    }
}

TEST_CASE("a table for the exact integral holds the function's points, and sees peaks between its entries")
{
    const TransferFunction function = greys({{0.0, 0.0}, {10.0, 0.0}, {10.01, 0.5}, {10.02, 0.0}, {255.0, 0.0}});
    const LookTable table = make_look_table(function, BYTES, 1.0, false, true);
    gpu::RaycastParams params{};
    set_look_table(params, function, BYTES, false, true);
    REQUIRE(params.point_count == 5);
    REQUIRE(table.texels.size() >= params.points + 2 * params.point_count);
    CHECK(table.texels[params.points + 2] == glm::vec4(0.5f));
    CHECK(table.texels[params.points + 5 + 2].x == float(BYTES.code_of(10.01)));
    CHECK(table.visible_intervals.back() > 0);
    const auto last = table.visible_intervals.size() - 1;
    CHECK(table.visible_intervals[last / 2] == table.visible_intervals[last]);  // nothing in the upper half
    for (const auto& [from, to] : {std::pair(300.0, 400.0), {-9.0, -5.0}})
        CHECK(make_look_table(greys({{from, 0.5}, {to, 0.5}}), BYTES, 1.0, false, true).visible_intervals.back() == 0);
}

TEST_CASE("a table says the depth of a step, also where its opacity rounds to 1")
{
    const TransferFunction function = greys({{0.0, 1.0 - 1e-12}, {255.0, 1.0 - 1e-12}});
    const LookTable table = make_look_table(function, BYTES, 3.0, false);
    gpu::RaycastParams params{};
    set_look_table(params, function, BYTES, false);
    CHECK(table.texels[0].a == 1.0f);
    for (const uint32_t entry : {0u, 1u, 2u, 3u, 4095u})
        CHECK(table.texels[params.table_depths + entry / 4][int(entry % 4)] ==
              doctest::Approx(-3.0 * std::log(1e-12)).epsilon(1e-4));
    CHECK(make_look_table(greys({{0.0, 1.0}, {255.0, 1.0}}), BYTES, 3.0, false).texels[params.table_depths].x ==
          gpu::OPAQUE_DEPTH);
}

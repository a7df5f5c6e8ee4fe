#include <doctest/doctest.h>

#include "tests/unit/annotation/patterns/flower_heads.h"

using namespace shvr;
using namespace shvr::test;

namespace {

double supply_value(const PatternRows& rows, const std::string& name)
{
    const std::optional<double> found = rows.value(name);
    REQUIRE_MESSAGE(found.has_value(), name << ": " << rows.reason(name));
    return *found;
}

/// 12 stem bundles that continue as spokes, with 6 florets on each; `rings` joins neighbouring spokes.
PatternRows spokes(bool rings)
{
    HeadBuilder head;
    std::vector<std::vector<uint32_t>> nodes;
    for (int i = 0; i < 12; ++i) {
        const double degrees = 30.0 * i;
        uint32_t last = head.vein({polar(8, degrees, -60), polar(8, degrees, -20)}, ABAXIAL_GROUP);
        nodes.emplace_back();
        for (int k = 0; k < 6; ++k) {
            const uint32_t next = head.node(polar(10 + 8 * k, degrees, -10), ABAXIAL_GROUP);
            head.link(last, next);
            const uint32_t floret = head.node(polar(10 + 8 * k, degrees, 10), FLORET_GROUP);
            head.link(next, floret);
            nodes.back().push_back(last = next);
        }
    }
    for (size_t i = 0; rings && i < 12; ++i) {
        const uint32_t between = head.node(polar(50, 30.0 * double(i) + 15.0, -10), ADAXIAL_GROUP);
        head.link(nodes[i][5], between);
        head.link(between, nodes[(i + 1) % 12][5]);
    }
    return head.measure();
}

}  // namespace

TEST_CASE("florets on one spoke are supplied by one bundle, those beside each other by others")
{
    for (const bool rings : {false, true}) {
        const PatternRows rows = spokes(rings);
        CHECK(supply_value(rows, "supply_bundles") == 12);
        CHECK(supply_value(rows, "supplied_florets") == 72);
        CHECK(supply_value(rows, "supply_overlap_row_1") == 1.0);
        CHECK(supply_value(rows, "supply_overlap_side_1") == 0.0);
        CHECK(supply_value(rows, "supply_sector_width") < 1e-9);
        // Without rings no second bundle is joined; with them the next spokes' are, on both sides.
        CHECK((supply_value(rows, "supply_overlap_side_3") > 0.1) == rings);
        CHECK(supply_value(rows, "supply_overlap_row_3") == 1.0);
    }
}

TEST_CASE("phantoms of mature heads supply all florets; those of earlier stages say how many")
{
    const auto rows = [](const char* stage) {
        return head_of(make_phantom({.size = Size3(48), .stage = stage})).measure();
    };
    const PatternRows d = rows("d"), c = rows("c"), b = rows("b");
    CHECK(supply_value(d, "supply_bundles") == 13);
    CHECK(supply_value(d, "supplied_florets") == 144);
    CHECK(supply_value(d, "supply_overlap_row_1") > supply_value(d, "supply_overlap_side_1"));
    CHECK(supply_value(c, "supplied_florets") == supply_value(c, "connections_abaxial_floret"));
    CHECK(supply_value(b, "supplied_florets") == 0);
    CHECK(b.reason("supply_sector_width") == "expected 2 bundles or more, joined with 8 florets or more");
}

#include <random>
#include <set>

#include <doctest/doctest.h>

#include "tests/support/volume_files.h"
#include "tests/unit/annotation/patterns/flower_heads.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Nine digits or none in each value, a unit in each row, five commas in each line.
void check_table(const PatternRows& rows)
{
    const std::string text = pattern_csv(rows, "um");
    for (const PatternRow& row : rows.rows()) {
        CHECK(row.value.has_value() == row.reason.empty());
        CHECK(contains(text, "pattern,,," + row.name + ","));
    }
    for (std::string_view rest = text; !rest.empty();) {
        const std::string line(rest.substr(0, rest.find("\r\n")));
        rest.remove_prefix(line.size() + 2);
        CAPTURE(line);
        if (!contains(line, "\"")) CHECK(std::ranges::count(line, ',') == 5);
        CHECK(line.back() != ',');
        CHECK(!contains(line, "nan"));
        CHECK(!contains(line, "inf,"));
    }
}

}  // namespace

TEST_CASE("the codebook's page is the code's own table of measures")
{
    const std::string page = bytes_of_file("engine/annotation/patterns/CODEBOOK.md");
    CHECK_MESSAGE(contains(page, pattern_codebook()), pattern_codebook());
    std::set<std::string> names;
    for (const PatternMeasure& measure : pattern_measures()) {
        CHECK(names.insert(measure.name).second);
        CHECK(std::string(measure.unit) != "");
        CHECK(std::string(measure.definition) != "");
    }
}

TEST_CASE("rows have the volume's unit, and a reason where there is no value")
{
    PatternRows rows;
    rows.add("head_radius", 1234.56789012345);
    rows.add("anastomoses_per_area", 1e-7);
    rows.add("axis_x", -0.0);
    rows.miss("droop", "the trace has none, \"none\"");
    CHECK(pattern_csv(rows, "um") ==
          "pattern,,,head_radius,1234.56789,um\r\npattern,,,anastomoses_per_area,1e-07,1/um^2\r\n"
          "pattern,,,axis_x,0,um\r\npattern,,,droop,,degree\r\n"
          "reason,,,\"droop: the trace has none, \"\"none\"\"\",,text\r\n");
    CHECK(contains(pattern_csv(rows, "=1,2"), "1234.56789,\"'=1,2\"\r\n"));
}

// Kind (Traces): traces without an axis, without sections, at one place or on a line
TEST_CASE("degenerate traces give reasons, and never NaN")
{
    const auto reason = [](const HeadBuilder& head) {
        const PatternRows rows = head.measure();
        check_table(rows);
        return rows.reason("head_radius");
    };
    HeadBuilder head;
    CHECK(reason(head) == "the nodes of the sections are at one place");
    head.node({5, 5, 5}, 2);
    CHECK(reason(head) == "the nodes of the sections are at one place");
    for (int i = 0; i < 9; ++i) head.node({5, 5, 5}, 2);
    head.link(0, 1);
    CHECK(reason(head) == "the nodes of the sections are at one place");
    head.vein({{5, 5, 5}, {6, 7, 8}, {7, 9, 11}}, 2);
    CHECK(reason(head) == "the sections lie on one straight line");
    HeadBuilder other;
    other.vein({{0, 0, 0}, {9, 1, 4}, {3, 3, 3}}, 9);
    CHECK(reason(other) == "the nodes of the sections are at one place");
    HeadBuilder cube;  // no axis differs from the others
    for (int i = 0; i < 8; ++i) cube.node({i % 2, i / 2 % 2, i / 4}, 2);
    CHECK(contains(reason(cube), "no axis differs"));
}

// Kind (Traces): random graphs in any sections, flat, far away, tiny and huge
TEST_CASE("random traces in random sections have finite values or reasons")
{
    for (uint32_t seed = 1; seed <= 60; ++seed) {
        CAPTURE(seed);
        std::mt19937 random(seed);
        const auto unit = [&] { return double(random()) / 4294967296.0 - 0.5; };
        const double size = std::pow(10.0, 12.0 * unit()), flat = seed % 3 == 0 ? 0.0 : 1.0;
        const int groups = 1 + int(random() % 4), places = seed % 4 == 0 ? 3 : 1000;
        HeadBuilder head;
        head.offset = seed % 5 == 0 ? glm::dvec3(1e6 * size) : glm::dvec3(0.0);
        const auto place = [&] { return double(int(places * unit())) / places; };
        const auto count = uint32_t(1 + random() % 60);
        for (uint32_t i = 0; i < count; ++i)
            head.node(size * glm::dvec3(place(), place(), flat * place()), uint8_t(1 + int(random()) % groups));
        std::set<std::pair<uint32_t, uint32_t>> linked;
        for (uint32_t i = 0; i < count; ++i) {
            const auto a = uint32_t(random() % count), b = uint32_t(random() % count);
            if (a == b || !linked.insert(std::minmax(a, b)).second) continue;
            head.links.push_back({a, b, uint8_t(1 + int(random()) % groups)});
        }
        check_table(head.measure());
    }
}

TEST_CASE("values do not depend on spacing or place, and lengths are in the volume's unit")
{
    HeadBuilder head = head_of(make_phantom({.size = Size3(48), .seed = 9}));
    const PatternRows plain = head.measure();
    // The same head in a volume that lies turned and mirrored, ten times as large.
    head.turn = glm::dmat3(10.0);
    for (TraceNode& node : head.nodes) node.position *= 10.0;
    const TraceSpace space{.size = {48, 48, 48},
                           .spacing = {10.0, 10.0, 10.0},
                           .unit = "um",
                           .directions = glm::dmat3(0, 1, 0, -1, 0, 0, 0, 0, 1),
                           .origin = {7, 8, 9}};
    const PatternRows turned = head.measure(space);
    REQUIRE(plain.rows().size() == turned.rows().size());
    for (size_t i = 0; i < plain.rows().size(); ++i) {
        const PatternRow &a = plain.rows()[i], &b = turned.rows()[i];
        CAPTURE(a.name);
        CHECK(a.name == b.name);
        if (a.name.starts_with("axis") || !a.value) continue;
        const std::string unit = a.measure->unit;
        const double factor = unit == "LENGTH" ? 10.0 : unit == "1/LENGTH^2" ? 0.01 : 1.0;
        CHECK(std::abs(*b.value - factor * *a.value) <= 1e-6 * std::max(1.0, std::abs(*b.value)));
    }
}

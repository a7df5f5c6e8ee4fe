// Looks: made from one scan, written, read, and applied to another.

#include "engine/session/looks/named_look.h"

#include <fstream>

#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Air at the lower end, tissue over the middle of a range.
VolumeStatistics statistics(double lower, double upper)
{
    VolumeStatistics statistics{.minimum = lower, .maximum = upper};
    statistics.histogram.assign(256, 0);
    for (int bin = 4; bin < 25; ++bin) statistics.histogram[size_t(bin)] = 1000;
    for (int bin = 64; bin < 218; ++bin) statistics.histogram[size_t(bin)] = 60;
    return statistics;
}

Session painted()
{
    Session session;
    session.transfer_function =
        TransferFunction({{.intensity = 1200.0, .color = glm::dvec3(1.0, 0.0, 0.0), .opacity = 0.0},
                          {.intensity = 2400.0, .opacity = 0.5}});
    session.light.ambient = 0.45;
    session.light.direction = {1.0, 2.0, 3.0};
    session.groups[2] = {.name = "xylem", .color = glm::dvec3(0.0, 1.0, 0.0), .opacity = 0.25, .visible = false};
    session.groups[7] = {.name = "phloem", .parent = 2, .locked = true};
    return session;
}

std::string refusal(const std::string& text)
{
    try {
        static_cast<void>(parse_look(text, "l", "l.json"));
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

constexpr const char* WHOLE = R"({"shvr_look": 1, "transfer_function": {"points": [{"at": 0, "opacity": 0},
    {"at": 1, "opacity": 1}]}, "light": {"ambient": 0.4}, "groups": {"3": {"name": "vein"}}})";

std::string replaced(const std::string& what, const std::string& by)
{
    std::string text = WHOLE;
    const size_t at = text.find(what);
    REQUIRE(at != std::string::npos);
    return text.replace(at, what.size(), by);
}

}  // namespace

TEST_CASE("a look that is written and read gives the next scan its groups, light and transfer function")
{
    const VolumeStatistics here = statistics(900.0, 2900.0), there = statistics(0.0, 250.0);
    const NamedLook look = look_of(painted(), "mine", here);
    const NamedLook read = parse_look(text_of(look), "mine", "mine.json");
    CHECK(text_of(read) == text_of(look));
    Session next;
    next.groups[7] = {.name = "old", .visible = false, .locked = true};
    next.groups[9] = {.name = "only here"};
    next = with_look(next, read, there);
    CHECK(next.light == painted().light);
    CHECK(next.groups.at(2).name == "xylem");
    CHECK(next.groups.at(2).visible);  // hiding is work on a scan, not a look
    CHECK(next.groups.at(2).opacity == 0.25);
    CHECK(next.groups.at(7).name == "phloem");
    CHECK(next.groups.at(7).parent == 2);
    CHECK_FALSE(next.groups.at(7).visible);
    CHECK(next.groups.at(7).locked);
    CHECK(next.groups.at(9).name == "only here");
    // The curve keeps its place within the tissue of each scan.
    const TissueRange before = tissue_range(here), after = tissue_range(there);
    const auto place = [](double intensity, const TissueRange& tissue) {
        return (intensity - tissue.lower) / (tissue.upper - tissue.lower);
    };
    CHECK(place(next.transfer_function.points()[0].intensity, after) == doctest::Approx(place(1200.0, before)));
    CHECK(place(next.transfer_function.points()[1].intensity, after) == doctest::Approx(place(2400.0, before)));
    // On its own scan it restores what it was made from.
    const Session same = with_look(painted(), read, here);
    CHECK(same.transfer_function.points()[1].intensity == doctest::Approx(2400.0));
    CHECK(same.groups == painted().groups);
}

TEST_CASE("a broken look is refused in one sentence that names file, key and what is expected")
{
    CHECK(refusal(WHOLE).empty());
    const auto is_refused = [](const std::string& text, const std::string& key) {
        const std::string said = refusal(text);
        CAPTURE(said);
        CHECK(said.starts_with("l.json: "));
        CHECK(said.find(key) != std::string::npos);
        CHECK(said.find("expected") != std::string::npos);
        CHECK(said.find('\n') == std::string::npos);
    };
    is_refused("[]", "");
    is_refused("{", "");
    is_refused("{}", "shvr_look");
    is_refused(replaced("\"shvr_look\": 1", "\"shvr_look\": 2"), "shvr_look");
    is_refused(replaced("\"light\"", "\"lights\""), "light");
    is_refused(replaced("0.4", "-1"), "light.ambient");
    is_refused(replaced("\"3\"", "\"0\""), "groups.0");
    is_refused(replaced("\"name\": \"vein\"", "\"parent\": 3"), "groups.3.parent");
    is_refused(replaced("\"at\": 1, \"opacity\": 1", "\"at\": 1, \"opacity\": 2"), "opacity");
    is_refused(replaced("\"at\": 0", "\"at\": 2"), "points");
    is_refused(replaced(R"({"at": 0, "opacity": 0},)", ""), "points");
}

TEST_CASE("a look whose parents do not fit the scan's own is refused")
{
    NamedLook look = parse_look(WHOLE, "l", "l.json");
    look.groups[3].parent = 4;
    Session session;
    session.groups[4].parent = 3;
    CHECK_THROWS_AS(with_look(session, look, statistics(0.0, 250.0)), Error);
}

TEST_CASE("looks of a folder are listed by name, without the broken ones, which are told")
{
    const TemporaryFolder folder;
    std::ofstream(folder.path / "b.json") << WHOLE;
    std::ofstream(folder.path / "a.json") << WHOLE;
    std::ofstream(folder.path / "c.json") << "{}";
    std::vector<std::string> warnings;
    const std::vector<NamedLook> looks = looks_in(folder.path, warnings);
    REQUIRE(looks.size() == 2);
    CHECK(looks[0].name == "a");
    CHECK(looks[1].name == "b");
    REQUIRE(warnings.size() == 1);
    CHECK(warnings[0].find("c.json") != std::string::npos);
    CHECK(is_look(WHOLE, "l.json"));
    CHECK_FALSE(is_look(R"({"points": []})", "l.json"));
    CHECK(look_file(folder.path, "mine") == folder.path / "mine.json");
    CHECK(error_of([&] { static_cast<void>(look_file(folder.path, "a/b")); }).find("no name for a look") !=
          std::string::npos);
}

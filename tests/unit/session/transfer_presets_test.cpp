// Presets of transfer functions: all shipped ones are valid and fit volumes of any range.

#include "engine/session/transfer_presets.h"

#include <fstream>

#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "tests/support/volume_files.h"

using namespace shvr;

namespace {

/// Air around 1000 and a broad tissue from 1400 to 2600.
VolumeStatistics statistics()
{
    VolumeStatistics statistics{.minimum = 900.0, .maximum = 2900.0};
    statistics.histogram.assign(256, 0);
    for (int bin = 4; bin < 25; ++bin) statistics.histogram[size_t(bin)] = 1000;
    for (int bin = 64; bin < 218; ++bin) statistics.histogram[size_t(bin)] = 60;
    return statistics;
}

std::string refusal(const std::string& text)
{
    try {
        parse_transfer_preset(text, "p", "p.json");
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("every preset that ships draws something of the tissue and nothing of the air")
{
    const std::vector<TransferPreset> presets = transfer_presets();
    CHECK(presets.size() >= 5);
    for (const TransferPreset& preset : presets) {
        CAPTURE(preset.name);
        CHECK(preset.note.ends_with("."));
        const TransferFunction function = transfer_function_of(preset, statistics());
        CHECK(function.at(2900.0).a > 0.0);
        CHECK(function.at(1000.0).a == 0.0);
        CHECK(transfer_preset_named(preset.name).points.size() == preset.points.size());
        CHECK_FALSE(transfer_function_of(preset, {}).draws_nothing());  // a volume without statistics
    }
}

TEST_CASE("a preset lies between where the air ends and where nine tenths of the rest do, and goes on to the end")
{
    const TissueRange tissue = tissue_range(statistics());
    CHECK(tissue.lower > 1050.0);
    CHECK(tissue.lower < 1700.0);
    CHECK(tissue.upper > 2300.0);
    CHECK(tissue.upper < 2600.0);
    const TransferPreset preset{
        .name = "p", .note = "", .points = {{0.0, glm::dvec3(0.0), 0.0}, {0.5, glm::dvec3(1.0), 0.4}}};
    const TransferFunction function = transfer_function_of(preset, statistics());
    REQUIRE(function.points().size() == 3);
    CHECK(function.points()[0].intensity == tissue.lower);
    CHECK(function.points()[1].intensity == doctest::Approx(0.5 * (tissue.lower + tissue.upper)));
    CHECK(function.points()[2].intensity == 2900.0);
    CHECK(function.points()[2].opacity == 0.4);
}

TEST_CASE("colour maps become brighter and more opaque with the intensity")
{
    for (const char* name : {"bone", "cividis", "grey", "magma", "viridis"}) {
        CAPTURE(name);
        const TransferPreset preset = transfer_preset_named(name);
        CHECK(preset.points.front().opacity == 0.0);
        CHECK(preset.points.back().intensity == 1.0);
        for (size_t i = 1; i < preset.points.size(); ++i) {
            const glm::dvec3 weights(0.2126, 0.7152, 0.0722);
            CHECK(glm::dot(preset.points[i].color, weights) > glm::dot(preset.points[i - 1].color, weights));
            CHECK(preset.points[i].opacity > preset.points[i - 1].opacity);
        }
    }
    CHECK(transfer_preset_named("fire").points.size() == 32);
}

TEST_CASE("a broken preset, and a name that there is not, are told in a sentence")
{
    CHECK(refusal(R"({"note": "x.", "points": []})") == "p.json: key points is []; expected at least two points");
    CHECK(refusal(R"({"note": "x.", "points": [{"at": 0.5, "color": "#ffffff", "opacity": 0},
                                               {"at": 0.4, "color": "#ffffff", "opacity": 0}]})")
              .starts_with("p.json: key points.1.at is 0.4; expected a number from 0.5 to "));
    CHECK(refusal(R"({"note": "x.", "points": [{"at": 0, "color": "#ffffff", "opacity": 2}]})")
              .starts_with("p.json: key points.0.opacity is 2; expected"));
    CHECK_THROWS_WITH(transfer_preset_named("nothing"),
                      "transfer_function.preset is \"nothing\"; expected one of: bone, bundles, cividis, fire, grey, "
                      "haze, heat, layers, magma, surface, viridis");
}

TEST_CASE("what a person keeps comes back as it was, in the volume that it was made for")
{
    const test::TemporaryFolder folder;
    const TransferFunction kept(
        {{950.0, glm::dvec3(0.0), 0.0}, {1700.0, glm::dvec3(1.0, 0.0, 0.0), 0.37}, {2500.0, glm::dvec3(1.0), 0.125}});
    const TransferPreset preset = preset_of(kept, "my vessels", statistics());
    std::ofstream(preset_file(folder.path, preset.name)) << text_of(preset);
    std::vector<std::string> warnings;
    const std::vector<TransferPreset> own = own_transfer_presets(folder.path, warnings);
    REQUIRE(own.size() == 1);
    CHECK(own[0].name == "my vessels");
    CHECK(own[0].is_own);
    CHECK(warnings.empty());
    const TransferFunction again = transfer_function_of(own[0], statistics());
    REQUIRE(again.points().size() == 3);  // it ends where it ended
    for (size_t i = 0; i < 3; ++i) {
        CHECK(again.points()[i].intensity == doctest::Approx(kept.points()[i].intensity).epsilon(1e-12));
        CHECK(again.points()[i].opacity == kept.points()[i].opacity);
        CHECK(again.points()[i].color == kept.points()[i].color);
    }
}

TEST_CASE("a broken file of a person's is told and left out; a folder that is not there holds none")
{
    const test::TemporaryFolder folder;
    folder.write("good.json", R"({"note": "n", "points": [{"at": 0, "color": "#000000", "opacity": 0},
                                                 {"at": 1, "color": "#ffffff", "opacity": 1}]})");
    folder.write("bad.json", R"({"note": "n", "points": []})");
    std::vector<std::string> warnings;
    const std::vector<TransferPreset> own = own_transfer_presets(folder.path, warnings);
    REQUIRE(own.size() == 1);
    CHECK(own[0].name == "good");
    CHECK(own[0].extends);
    REQUIRE(warnings.size() == 1);
    CHECK(test::contains(warnings[0], "bad.json"));
    CHECK(own_transfer_presets(folder.path / "missing", warnings).empty());
    CHECK(warnings.size() == 1);
}

TEST_CASE("names that are none of files are refused")
{
    CHECK(preset_file("/a", "leaf traces, dark") == "/a/leaf traces, dark.json");
    for (const std::string& name : {std::string(""), std::string("a/b"), std::string(".hidden"), std::string("a\nb"),
                                    std::string("  "), std::string(101, 'a')})
        CHECK_THROWS_AS(preset_file("/a", name), Error);
    CHECK_THROWS_AS(preset_of(TransferFunction(), "a", statistics()), Error);
    CHECK(why_no_name("leaf, dark", "look").empty());
    CHECK(
        why_no_name("..", "look").starts_with("\"..\" is no name for a look, since it begins with a dot; expected 1"));
    CHECK(why_no_name("a/b", "look").find("since it has a /;") != std::string::npos);
    CHECK(why_no_name(std::string(200, 'a'), "look").find("since it is too long;") != std::string::npos);
}

// Cost and combination of features. A scene pays only for what it contains: an unused feature has no pass, no byte and
// no bit. Any two features draw together without a validation message.

#include <algorithm>
#include <string_view>

#include <doctest/doctest.h>

#include "tests/gpu/matrix/feature_list.h"

using namespace shvr;
using namespace shvr::test;

namespace {

std::set<std::string> without_of(std::set<std::string> names, const std::set<std::string>& known)
{
    for (const std::string& name : known) names.erase(name);
    return names;
}

std::set<std::string> names_of(const Picture& picture)
{
    std::set<std::string> names;
    for (const gpu::PassReport& pass : picture.passes) names.insert(pass.name);
    for (const PassData& pass : picture.graph.passes())
        if (!pass.kernel.empty()) names.insert(pass.kernel);
    return names;
}

/// A covering array of strength 2: a picture a row, a feature of FEATURES a column. The last four columns exclude each
/// other: they are values of view.arrangement. matrix/pairs_slow_test.cpp draws each pair by itself.
constexpr std::string_view TOGETHER[] = {
    "1111101001000011110010000", "0010001001101000001101000", "1111110111100101101100100", "1110100111110000000100010",
    "0000101101110100111100001", "0110111011111110111110000", "1101001110010111010101000", "0000001000011010010010100",
    "0001011000001111111010010", "1111010010001011000010001", "0001010110011000001000000", "1000110100111001111011000"};
constexpr size_t ARRANGEMENTS = 4, SLICES = 24, OVERVIEW = 23;

/// Names the pairs of values that no picture of TOGETHER has. Two features must be on together in a picture from a
/// camera, since an overview and slices leave some features out; and each in a picture whose exact paged bricks are
/// compared with resident ones.
std::string missing_pairs()
{
    const auto column_of = [](const std::string& name) {
        return size_t(std::ranges::find(FEATURES, name, &Feature::name) - FEATURES.begin());
    };
    const size_t count = FEATURES.size(), paged = column_of("bricks that come and go");
    const size_t filtered = column_of("filtered sampling");
    std::string missing;
    for (size_t a = 0; a < count; ++a) {
        const bool is_compared = a == filtered || std::ranges::any_of(TOGETHER, [&](std::string_view row) {
                                     return row[a] == '1' && row[paged] == '1' && row[filtered] == '0';
                                 });
        if (!is_compared) missing += sentence(FEATURES[a].name, " is not compared; ");
        for (size_t b = a + 1; b < count; ++b)
            for (const char* values : {"00", "01", "10", "11"}) {
                const bool are_both = values == std::string_view("11"), exclude = a >= count - ARRANGEMENTS;
                const auto has = [&](std::string_view row) {
                    const bool is_from_a_camera =
                        b >= count - ARRANGEMENTS || (row[OVERVIEW] == '0' && row[SLICES] == '0');
                    return row[a] == values[0] && row[b] == values[1] && (!are_both || is_from_a_camera);
                };
                if ((are_both && exclude) || std::ranges::any_of(TOGETHER, has)) continue;
                missing += sentence(FEATURES[a].name, ", ", FEATURES[b].name, ": ", values, "; ");
            }
    }
    return missing;
}

}  // namespace

TEST_CASE("a scene has the passes and the storages of what is in it, and no others")
{
    // One renderer each: temporary memory is kept for reuse.
    const auto drawn = [](const Scenery& scenery) {
        Everything everything;
        const std::set<std::string> names = names_of(everything.draw(scenery));
        return std::pair{names, everything.storages()};
    };
    const Scenery plain = Everything().plain();
    const auto [passes, storages] = drawn(plain);
    CHECK((passes == std::set<std::string>{"leap_occupancy", "leap_distance", "leap_distance_last", "leap_distance x",
                                           "leap_distance y", "leap_distance z", "sample_bits",
                                           "upload transfer function", "raycast", "read back color"}));
    const auto without = [](const std::set<std::string>& names, const std::set<std::string>& known) {
        std::string list;
        for (const std::string& name : without_of(names, known)) list += name + "; ";
        return list;
    };
    for (const Feature& feature : FEATURES) {
        CAPTURE(std::string(feature.name));
        Scenery scenery = plain;
        feature.add(scenery);
        const auto [more_passes, more_storages] = drawn(scenery);
        CHECK(without(without_of(more_passes, passes), feature.passes) == "");
        CHECK(without(feature.passes, more_passes) == "");
        CHECK(without(without_of(more_storages, storages), feature.storages) == "");
        CHECK(without(feature.storages, more_storages) == "");
    }
}

TEST_CASE_FIXTURE(Everything, "what a feature had is given back with it")
{
    const std::set<std::string> lasting{"mask",          "mask table",    "occlusion cells", "occlusion values",
                                        "surface list",  "surface nodes", "cell leap",       "brick staging",
                                        "page directory"};
    for (const Feature& feature : FEATURES) {
        CAPTURE(std::string(feature.name));
        Scenery scenery = plain();
        feature.add(scenery);
        draw(scenery);
        draw(plain());
        for (const std::string& name : storages()) CHECK_MESSAGE(!lasting.contains(name), name, " is still there");
    }
}

TEST_CASE_FIXTURE(Everything, "neutral settings change no bit")
{
    const Scenery plain = this->plain();
    const ImageF image = draw(plain).image;
    const std::pair<const char*, std::function<void(Scenery&)>> neutral[] = {
        {"blend of size 0", [](Scenery& s) { s.session.blend = {.size = 0.0, .rate = 3.0, .color = GREEN}; }},
        {"occlusion of strength 0", [](Scenery& s) { s.session.light.occlusion = {.strength = 0.0, .radius = 9.0}; }},
        {"occlusion without shading", [](Scenery& s) { s.session.light.occlusion = {.strength = 1.0}; }},
        {"a shell of opacity 0",
         [](Scenery& s) {
             s.options.probe = probe_of(0.0, true);
             s.options.probe->shell->opacity = 0.0;
         }},
        {"a preview of nothing",
         [](Scenery& s) {
             s.options.probe = probe_of(0.0, false);
             s.options.probe->preview = std::make_shared<PaintPreview>();
         }},
        {"a cut around everything",
         [](Scenery& s) {
             s.session.cut = {{0, 0, 0}, {48, 48, 48}};
         }},
        {"an oblique plane that cuts nothing",
         [](Scenery& s) {
             s.session.cut.plane_normal = glm::dvec3(1.0, 2.0, -1.0);
             s.session.cut.plane_point = glm::dvec3(48.5, 48.5, -0.5);
         }},
        {"eyes at no distance",
         [](Scenery& s) {
             s.session.view.arrangement = Arrangement::stereo;
             s.session.view.stereo = {.output = StereoOutput::anaglyph, .eye_distance = 0.0};
         }},
        {"bricks that come and go", [](Scenery& s) { s.paging = Paging::always; }},
        {"no leaps", [](Scenery& s) { s.session.render.skip_empty_space = false; }},
        {"smooth borders of nothing", [](Scenery& s) { s.session.render.smooth_borders = true; }},
        {"work counters", [](Scenery& s) { s.options.count_work = true; }},
        {"surfaces out of sight", [](Scenery& s) {
             s.session.surfaces = {{{500, 0, 0}, {501, 0, 0}, 1.0, 1.0, RED}};
         }}};
    for (const auto& [name, apply] : neutral) {
        CAPTURE(std::string(name));
        Scenery scenery = plain;
        apply(scenery);
        check_below("differing bits", double(different_bits(draw(scenery).image, image)), 0.0);
    }
}

TEST_CASE_FIXTURE(Everything, "an oblique plane across an axis cuts whatever is drawn as the box does")
{
    bool is_upper = false;
    for (const Feature& feature : FEATURES) {
        CAPTURE(std::string(feature.name));
        Scenery with_box = plain();
        feature.add(with_box);
        if (with_box.session.cut.plane_normal) continue;
        Scenery with_plane = with_box;
        is_upper = !is_upper;
        (is_upper ? with_box.session.cut.upper : with_box.session.cut.lower).y = 20.375;
        with_plane.session.cut.plane_normal = glm::dvec3(0.0, is_upper ? 3.0 : -3.0, 0.0);
        with_plane.session.cut.plane_point = glm::dvec3(7.0, 20.375, -5.0);
        const Pixels boxed = pixels_of(draw(with_box).image), cut = pixels_of(draw(with_plane).image);
        check_below("difference between plane and box", worst_difference(boxed, cut), 1e-4);
    }
}

TEST_CASE_FIXTURE(Everything, "any two features go together, each on and off")
{
    for (const std::string_view row : TOGETHER) REQUIRE(row.size() == FEATURES.size());
    CHECK(std::string(FEATURES[OVERVIEW].name) == "overview");
    CHECK(std::string(FEATURES[SLICES].name) == "slices");
    CHECK(missing_pairs() == "");
    for (const std::string_view row : TOGETHER) {
        CAPTURE(std::string(row));
        CHECK(std::ranges::count(row.substr(row.size() - ARRANGEMENTS), '1') <= 1);
        Scenery scenery = plain();
        for (size_t i = 0; i < row.size(); ++i)
            if (row[i] == '1') FEATURES[i].add(scenery);
        const Picture picture = check(scenery);
        const std::vector<float>& rgba = picture.image.rgba;
        CHECK(std::set<float>(rgba.begin(), rgba.end()).size() > 50);  // something is seen
    }
}

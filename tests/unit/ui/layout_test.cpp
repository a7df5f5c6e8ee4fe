#include "engine/workbench/appearance/layout.h"

#include <set>

#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/workbench/appearance/glyphs.h"
#include "engine/workbench/bindings/hints.h"
#include "engine/workbench/bindings/preferences_file.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

TEST_CASE("The panels at the side take what is wanted, but never more than half of the window")
{
    constexpr double FONT = 14.0;
    WindowLayout layout;
    CHECK(side_units(layout, 1280.0, FONT) == doctest::Approx(SIDE_WIDTH * FONT));
    CHECK(side_units(layout, 500.0, FONT) == doctest::Approx(250.0));
    CHECK(side_units(layout, 1280.0, 28.0) == doctest::Approx(640.0));
    layout.side_width = 40.0;
    CHECK(side_units(layout, 1280.0, FONT) == doctest::Approx(560.0));
    layout.side_width = 3.0;
    CHECK(side_units(layout, 1280.0, FONT) == doctest::Approx(MIN_SIDE_WIDTH * FONT));
    layout.shows_side = false;
    CHECK(side_units(layout, 1280.0, FONT) == 0.0);
    layout.shows_side = true;
    for (const PanelRow& row : panel_rows()) layout.panels[row.id].place = PanelPlace::floating;
    CHECK(side_units(layout, 1280.0, FONT) == 0.0);
    layout.panels["groups"].place.reset();
    CHECK(side_units(layout, 1280.0, FONT) > 0.0);
}

TEST_CASE("Where a window was left is kept, and no window that is not known")
{
    const Preferences kept = patched(Preferences{}, patch_of_window("help", {3.5, 4.0}, {40.0, 30.5}));
    REQUIRE(kept.layout.windows.contains("help"));
    CHECK(kept.layout.windows.at("help") == WindowPlace{glm::dvec2(3.5, 4.0), glm::dvec2(40.0, 30.5)});
    CHECK(patched(kept, patch_of_window("operations", {1.0, 2.0}, {9.0, 9.0})).layout.windows.size() == 2);
    CHECK(patched(kept, R"({"layout":null})").layout == WindowLayout{});
    CHECK_THROWS_AS(patched(Preferences{}, patch_of_window("elsewhere", {1.0, 1.0}, {2.0, 2.0})), Error);
    CHECK(patched(Preferences{}, R"({"budget_device_mib":512})").budget_device_mib == 512.0);
    CHECK_THROWS_AS(patched(Preferences{}, R"({"budget_device_mib":3})"), Error);
}

TEST_CASE("Panels have ids of their own, and what nobody changed is as it ships")
{
    std::set<std::string> ids;
    for (const PanelRow& row : panel_rows()) {
        CHECK(ids.insert(row.id).second);
        CHECK(panel_named(row.id) == &row);
        CHECK((WindowLayout().place_of(row) == row.place));
    }
    CHECK(panel_named("curtains") == nullptr);
    WindowLayout layout;
    layout.panels["history"].folded = false;
    CHECK_FALSE(layout.is_folded(*panel_named("history")));
    CHECK(layout.is_folded(*panel_named("light")));
    CHECK(layout.is_folded(*panel_named("touch")));
}

TEST_CASE("A floating panel comes back into a window that became smaller")
{
    CHECK(within_reach({100, 50}, {200, 100}, {1000, 800}) == glm::dvec2(100, 50));
    CHECK(within_reach({1900, 900}, {200, 100}, {1000, 800}) == glm::dvec2(800, 700));
    CHECK(within_reach({-40, 20}, {3000, 100}, {1000, 800}) == glm::dvec2(0, 20));
}

TEST_CASE("Preferences of look and layout are kept, patched, and given back")
{
    TemporaryFolder folder;
    Preferences preferences =
        patched(Preferences(), R"({"theme":"light","font_pixels":18,"scale":1.5,"hints_seen":2})");
    CHECK((preferences.theme == Theme::light));
    CHECK(preferences.font_pixels == 18.0);
    CHECK(preferences.scale == std::optional(1.5));
    preferences =
        patched(preferences, patch_of_panel("groups", {.place = PanelPlace::floating, .at = glm::dvec2(3, 4)}));
    preferences = patched(preferences, patch_of_panel("trace", {.folded = true}));
    preferences = patched(preferences, R"({"layout":{"side_width":30}})");
    preferences.note_opened("/tmp/scan.json");
    const std::filesystem::path file = folder.path / "preferences.json";
    save_preferences(file, preferences);
    CHECK((load_preferences(file) == preferences));
    const WindowLayout& layout = preferences.layout;
    CHECK((layout.place_of(*panel_named("groups")) == PanelPlace::floating));
    CHECK(layout.panels.at("groups").at == std::optional(glm::dvec2(3, 4)));
    CHECK(layout.is_folded(*panel_named("trace")));

    // Keys that a patch does not name keep their values; null restores the default.
    const Preferences size_only = patched(preferences, patch_of_panel("groups", {.size = glm::dvec2(20, 10)}));
    CHECK((size_only.layout.place_of(*panel_named("groups")) == PanelPlace::floating));
    CHECK((patched(preferences, R"({"layout":null})").layout == WindowLayout()));
    CHECK_FALSE(patched(preferences, R"({"scale":null})").scale.has_value());
    CHECK_THROWS_WITH_AS(static_cast<void>(patched(Preferences(), R"({"theme":"blue"})")),
                         doctest::Contains("theme is \"blue\"; expected"), Error);
    CHECK_THROWS_AS(static_cast<void>(patched(Preferences(), R"({"font_pixels":400})")), Error);
    CHECK_THROWS_AS(static_cast<void>(patched(Preferences(), R"({"layout":{"panels":{"curtains":{}}}})")), Error);
    CHECK_THROWS_AS(static_cast<void>(patched(Preferences(), "[1]")), Error);
}

// Kind (Window): one bad shortcut in the preferences
TEST_CASE("A bad shortcut in the preferences spoils only itself, is named, and stays in the file")
{
    TemporaryFolder folder;
    folder.write(
        "preferences.json",
        R"({"shvr_preferences":1,"theme":"light","keys":{"undo":{"keys":"Ctrl+U"},"redo":{"keys":"Ctrl+Nonsense"},)"
        R"("unheard_of":{"keys":"F6"}}})");
    const std::filesystem::path file = folder.path / "preferences.json";
    std::vector<std::string> complaints;
    Preferences preferences = load_preferences(file, &complaints);
    CHECK((preferences.theme == Theme::light));
    CHECK(Keymap(preferences.key_set, preferences.keys).text_of(*shortcut_named("undo")) == "Ctrl + U");
    CHECK(Keymap(preferences.key_set, preferences.keys).text_of(*shortcut_named("redo")) == "Ctrl + Y");
    REQUIRE(complaints.size() == 2);
    CHECK(complaints[0].find("preferences.json: keys: redo is 'Ctrl+Nonsense'; expected a key") != std::string::npos);
    CHECK(complaints[1].find("'unheard_of' is no shortcut; expected") != std::string::npos);

    // A newer program may know them, so that saving another choice keeps them.
    preferences = patched(preferences, R"({"theme":"dark"})");
    save_preferences(file, preferences);
    CHECK((load_preferences(file) == preferences));
    CHECK(read_text(file, int64_t{1} << 20).find("Ctrl+Nonsense") != std::string::npos);
    // A patch is refused as before.
    CHECK_THROWS_WITH_AS(static_cast<void>(patched(preferences, R"({"keys":{"save":{"keys":"Ctrl+Else"}}})")),
                         doctest::Contains("save is 'Ctrl+Else'"), Error);
    CHECK((patched(preferences, R"({"keys":{"redo":{"keys":"F6"}}})").unusable_keys.size() == 1));
}

TEST_CASE("The fonts learn each character once, from any text")
{
    GlyphSet glyphs;
    CHECK_FALSE(glyphs.add("plain, and \u00b5m \u2013 K\u00f6ln"));
    CHECK_FALSE(glyphs.has_rare());
    CHECK(glyphs.add("\u0391\u03bf\u03c1\u03c4\u03ae"));  // Greek: every font has it
    CHECK_FALSE(glyphs.has_rare());
    CHECK(glyphs.add("\u8840\u7ba1"));
    CHECK(glyphs.has_rare());
    CHECK_FALSE(glyphs.add("\u7ba1\u8840"));
    CHECK_FALSE(glyphs.add("\xff\xc3 \xe8\xa1"));  // broken
    bool has = false;
    for (const auto& [first, last] : glyphs.ranges()) {
        CHECK(first <= last);
        has = has || (first <= 0x7ba1 && 0x7ba1 <= last);
    }
    CHECK(has);
    CHECK(glyphs.add(uint32_t{0x5d0}));
    CHECK_FALSE(glyphs.add(uint32_t{0x1f600}));  // above what Dear ImGui knows
}

TEST_CASE("The first hints name keys as they are")
{
    const Keymap shipped, changed(KeySet::modern, {{"undo", {"Ctrl+U"}}, {"fit_view", {}}});
    CHECK(first_hint(2, shipped).find("(Ctrl + Z)") != std::string::npos);
    CHECK(first_hint(2, changed).find("(Ctrl + U)") != std::string::npos);
    CHECK(first_hint(0, shipped).find("Fit (Home)") != std::string::npos);
    CHECK(first_hint(0, changed).find("Fit brings") != std::string::npos);
    CHECK(name_with_key("fit_view", shipped) == "Fit (Home)");
}

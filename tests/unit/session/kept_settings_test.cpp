// Between lasting and kept settings everything is divided that a person changes.

#include "engine/session/kept_settings.h"

#include <map>
#include <set>

#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/session/lasting_settings.h"
#include "engine/session/session_keys.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

const std::string SMALLEST = R"({"shvr_session": 1, "volume": {"path": "a.nhdr"}})";

Session parse(const std::vector<std::string>& settings = {})
{
    return parse_session(SMALLEST, "/data/scans", "s.json", settings);
}

/// Why a section of the session's file is in neither.
const std::map<std::string, std::string> NOT_KEPT{
    {"shvr_session", "the version of the file"},
    {"volume", "what all is about; the journal names it"},
    {"surfaces", "from the file alone; nothing in the program changes them"},
    {"annotation", "the names of files, which the work itself holds"},
};

/// A setting of each section that a person may change.
const std::vector<std::string> CHANGES{"camera=top",
                                       "cameras.mine.side=left",
                                       R"(key_looks.mine={"transfer_function":{"points":[]},"cut":{"lower":[1,2,3]}})",
                                       "render.step_voxels=0.25",
                                       "view.arrangement=slices",
                                       "interaction.frames_per_second=7",
                                       "probe.group=9",
                                       "probe.voxel=[1,2,3.5]",
                                       "probe.density.offset=4",
                                       "view.slices.black=-3",
                                       "view.solo=3",
                                       "interaction.workspace_scale=2",
                                       "probe.color=#102030"};

}  // namespace

TEST_CASE("every section of a session is lasting, kept, or left out for a reason, and none is two of them")
{
    SettingValues lasting = lasting_settings(parse());
    const SettingValues kept = kept_settings(parse());
    lasting.erase("picture");  // keys of `render`, below
    std::set<std::string> sections;
    for (const SessionKey& key : session_keys()) sections.insert(key.name.substr(0, key.name.find('.')));
    CHECK(sections.size() >= 14);
    for (const std::string& section : sections) {
        const std::string name = section == "camera" ? "cameras" : section;
        const int places = int(lasting.contains(name)) + int(kept.contains(name)) + int(NOT_KEPT.contains(name));
        CHECK_MESSAGE(places == 1, name, " is in ", places, " of them; see kept_settings.h");
    }
    for (const auto& [name, reason] : NOT_KEPT) CHECK_MESSAGE(sections.contains(name), name);
    for (const SettingValues& values : {lasting, kept})
        for (const auto& [name, value] : values) CHECK_MESSAGE(sections.contains(name), name);
}

TEST_CASE("every key of rendering is lasting, as of the picture, or kept")
{
    RenderSettings render;
    std::set<std::string> all, parts, named(std::begin(PICTURE_KEYS), std::end(PICTURE_KEYS));
    for (const SessionKey& key : keys_of([&](Fields& f) { fields(f, render); })) all.insert(key.name);
    for (const SessionKey& key : keys_of([&](Fields& f) { picture_fields(f, render); })) parts.insert(key.name);
    CHECK(parts == named);
    for (const SessionKey& key : keys_of([&](Fields& f) { rendering_fields(f, render); }))
        CHECK_MESSAGE(parts.insert(key.name).second, key.name);
    CHECK(parts == all);
    for (const char* setting :
         {"render.background=#20406080", "render.smooth_borders=true", "render.saturation=0.25"}) {
        CAPTURE(setting);
        const Session changed = parse({setting});
        CHECK(kept_settings(changed) == kept_settings(parse()));
        CHECK(lasting_settings(changed) != lasting_settings(parse()));
        Session session = parse();
        set_lasting_settings(session, lasting_settings(changed));
        CHECK(session == changed);
        // Kept settings do not include it, and render keys that older journals keep do not change it.
        set_kept_settings(session, kept_settings(parse()));
        CHECK(session == changed);
        set_kept_settings(session, {{"render", R"({"background":"#000000","saturation":1,"step_voxels":0.5})"}});
        CHECK(session == changed);
    }
}

TEST_CASE("what is kept comes back as it was, section by section")
{
    for (const std::string& setting : CHANGES) {
        CAPTURE(setting);
        const Session changed = parse({setting});
        const SettingValues values = kept_settings(changed);
        CHECK(values != kept_settings(parse()));
        CHECK(lasting_settings(changed) == lasting_settings(parse()));
        Session session = parse();
        set_kept_settings(session, values);
        CHECK(session == changed);
        CHECK(normalized_kept_settings(values) == values);
        // A camera's name goes with it.
        const std::string section = setting.starts_with("camera") ? "cameras" : setting.substr(0, setting.find('.'));
        Session other = parse();
        set_kept_settings(other, {{section, values.at(section)}});
        CHECK(other == changed);
        set_kept_settings(other, kept_settings(parse()));
        CHECK(other == parse());
    }
    const std::string text = read_text("tests/unit/session/written_everything.json", 1 << 20);
    const Session whole = parse_session(text, "/data/scans", "s.json");
    Session session = parse();
    set_kept_settings(session, kept_settings(whole));
    take_kept_sections(session, whole);
    CHECK(kept_settings(session) == kept_settings(whole));
    CHECK(session.probe == whole.probe);
    CHECK(session.surfaces.empty());
}

TEST_CASE("kept settings that cannot be read are refused by key, and nothing is changed")
{
    const Session before = parse({"probe.group=4"});
    const auto refusal = [&](const SettingValues& values) {
        Session session = before;
        const std::string message = error_of([&] { set_kept_settings(session, values); });
        CHECK(session == before);
        return message;
    };
    CHECK(contains(refusal({{"interaction", "{\"resolution\":0.5}"}, {"probe", "{\"group\":256}"}}),
                   "key probe.group is 256; expected"));
    CHECK(contains(refusal({{"light", "{}"}}), "unknown key light"));
    CHECK(contains(refusal({{"view", "{"}}), "settings"));
    CHECK(contains(refusal({{"cameras", "{\"camera\":\"none\",\"cameras\":{}}"}}), "none"));
    CHECK(refusal({}).empty());
}

TEST_CASE("sections that are set for this time only are not kept")
{
    const SettingValues values = kept_settings(parse());
    CHECK(values.size() == 6);
    for (const char* setting : {"camera=top", "cameras.a.side=left"})
        CHECK_FALSE(without_overridden(values, {setting}).contains("cameras"));
    const SettingValues rest = without_overridden(values, {"render.size=[1,2]", "probe={}"});
    CHECK(rest.size() == 4);
    CHECK_FALSE(rest.contains("probe"));
    const SettingValues lasting = lasting_settings(parse());
    REQUIRE(lasting.contains("picture"));
    for (const char* setting : {"render.background=#000000", "render.saturation=0", "render={}"})
        CHECK_FALSE(without_overridden(lasting, {setting}).contains("picture"));
    CHECK(without_overridden(lasting, {"render.size=[1,2]"}) == lasting);
    CHECK(without_overridden(values, {"render.background=#000000"}) == values);
}

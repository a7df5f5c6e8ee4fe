// The table of keys: written files, README.md, and --set.

#include "engine/session/session_keys.h"

#include <algorithm>
#include <set>
#include <sstream>

#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/base/file.h"

using namespace shvr;

namespace {

const std::string SMALLEST = R"({"shvr_session": 1, "volume": {"path": "a.nhdr"}})";

Session parse(const std::string& text, const std::vector<std::string>& settings = {})
{
    return parse_session(text, "/data/scans", "s.json", settings);
}

/// Without the comma at the end of a line.
std::vector<std::string> lines_of(const std::string& text)
{
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line); lines.push_back(line))
        if (line.ends_with(',')) line.pop_back();
    return lines;
}

std::string row_of(const SessionKey& key)
{
    std::string name = key.name;
    const std::string camera = "cameras.NAME.";
    if (name.starts_with(camera)) name.erase(0, camera.size());  // README.md lists them in a separate table
    return sentence("| `", name, "` | ", key.meaning, " | ", key.allowed, " | ", key.standard, " |");
}

}  // namespace

TEST_CASE("a session is written as version 1 has always been written, but for keys that are new")
{
    // Written at commit 1462cd9, before the table of keys existed.
    for (const char* file :
         {"tests/unit/session/written_everything.json", "tests/unit/session/written_procedural.json"}) {
        CAPTURE(file);
        const std::string text = read_text(file, 1 << 20);
        const std::vector<std::string> before = lines_of(text), now = lines_of(to_text(parse(text), "/data/scans"));
        auto at = now.begin();
        for (const std::string& line : before) {
            at = std::find(at, now.end(), line);
            CAPTURE(line);
            REQUIRE(at != now.end());
            ++at;
        }
    }
}

TEST_CASE("README.md says of each key what the program says, and of no other")
{
    std::set<std::string> rows, written;
    for (const SessionKey& key : session_keys()) rows.insert(row_of(key));
    std::istringstream readme(read_text("engine/session/README.md", 1 << 20));
    for (std::string line; std::getline(readme, line);)
        if (line.starts_with("| `")) written.insert(line);
    for (const std::string& row : rows)
        if (!written.contains(row)) FAIL_CHECK("missing in engine/session/README.md:\n" << row);
    for (const std::string& row : written)
        if (!rows.contains(row)) FAIL_CHECK("no key's row, in engine/session/README.md:\n" << row);
}

TEST_CASE("every key of a written session is in the table")
{
    const std::vector<SessionKey> keys = session_keys();
    const auto is_known = [&](const std::string& name) {
        return std::ranges::any_of(keys, [&](const SessionKey& key) { return key.covers(name); });
    };
    for (const char* name : {"volume.raw", "light.occlusion.rays", "groups.7.color", "cameras.left eye.near",
                             "transfer_function.points.12.opacity", "surfaces.3.radii", "view.slices.black"})
        CHECK_MESSAGE(is_known(name), name);
    for (const char* name : {"", "light", "light.ambience", "groups", "groups.7.color.red"})
        CHECK_FALSE_MESSAGE(is_known(name), name);
}

TEST_CASE("--set takes a text as it stands where the key is a text, whatever it looks like")
{
    CHECK(parse(SMALLEST, {"groups.7.name=007"}).groups.at(7).name == "007");
    CHECK(parse(SMALLEST, {"groups.7.name=true"}).groups.at(7).name == "true");
    CHECK(parse(SMALLEST, {"volume.channel=2"}).open_options.channel == "2");
    CHECK(parse(SMALLEST, {R"(volume.channel="2")"}).open_options.channel == "2");
    CHECK(parse(SMALLEST, {"annotation.mask=1.mask"}).mask_path == "/data/scans/1.mask");
    CHECK(parse(SMALLEST, {"annotation.mask=1"}).mask_path == "/data/scans/1");
    CHECK(parse(SMALLEST, {"light.ambient=0.25"}).light.ambient == 0.25);
    CHECK_THROWS_AS(parse(SMALLEST, {"light.ambient=\"0.25\""}), Error);
}

TEST_CASE("sessions are equal where everything in them is")
{
    const std::string text = read_text("tests/unit/session/written_everything.json", 1 << 20);
    const Session session = parse(text);
    CHECK(session == parse(text));
    for (const char* setting : {"light.ambient=0.9", "transfer_function.points.0.opacity=0.5", "groups.1.name=vein",
                                "camera=top", "cut.lower.0=2", "probe.group=8", "view.slices.zoom=2",
                                "surfaces.0.radius=9", "annotation.trace=other.graphml", "volume.spacing.0=9",
                                "render.size.0=7", "blend.rate=9", "interaction.resolution=1"}) {
        CAPTURE(setting);
        CHECK_FALSE(session == parse(text, {setting}));
    }
}

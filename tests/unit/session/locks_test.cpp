// Locks of groups and the brush that is held to unpainted voxels, in session files and in the history.

#include <doctest/doctest.h>

#include "engine/annotation/work/work.h"
#include "engine/session/lasting_settings.h"
#include "engine/session/words/setting_words.h"
#include "tests/support/random_annotation.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

Session parse(const std::string& more, const std::vector<std::string>& settings = {})
{
    return parse_session(R"({"shvr_session": 1, "volume": {"path": "a.nhdr"})" + more + "}", "/data", "s.json",
                         settings);
}

std::string refusal(const std::string& setting)
{
    return error_of([&] { parse("", {setting}); });
}

const std::string GROUPS = R"(, "groups": {"1": {"locked": true}, "2": {"parent": 1}, "7": {"locked": false}})";

}  // namespace

TEST_CASE("a lock is read, written, set from the command line, and off where nothing is said")
{
    const Session session = parse(GROUPS);
    CHECK(session.groups.at(1).locked);
    CHECK_FALSE(session.groups.at(2).locked);
    CHECK(locked_groups(session.groups).to_string() == GroupSet(0b110).to_string());
    CHECK(parse_session(to_text(session, "/data"), "/data", "s.json") == session);
    CHECK(parse(GROUPS, {"groups.1.locked=false"}).groups.at(1).locked == false);
    CHECK(parse("", {"groups.255.locked=true"}).groups.at(255).locked);
    for (const char* wrong : {"groups.1.locked=1", "groups.1.locked=\"true\"", "groups.1.locked=null"}) {
        CAPTURE(wrong);
        CHECK(contains(refusal(wrong), "groups.1.locked"));
        CHECK(contains(refusal(wrong), "expected true or false"));
    }
}

TEST_CASE("a brush that is held to unpainted voxels is a setting of the probe, and no step of the history")
{
    CHECK_FALSE(parse("").probe.brush.only_unpainted);
    const Session session = parse(R"(, "probe": {"only_unpainted": true})");
    CHECK(session.probe.brush.only_unpainted);
    CHECK(stroke_of(session.probe.brush, 5.0).only_unpainted);
    CHECK(parse_session(to_text(session, "/data"), "/data", "s.json") == session);
    CHECK(contains(refusal("probe.only_unpainted=0"), "expected true or false"));
    CHECK(lasting_settings(session) == lasting_settings(parse("")));
}

TEST_CASE("locking is a step like any other: journalled, undone, and told by its name")
{
    const TemporaryFolder folder;
    WorkFiles files = files_in(folder.path);
    Session session = parse(GROUPS);
    const SettingValues before = lasting_settings(session);
    files.settings = before;
    files.normalized = normalized_settings;
    session.groups[7].locked = true;
    {
        Work work(ANNOTATED_SIZE, ANNOTATED_TYPE);
        work.open(files);
        const SettingValues after = lasting_settings(session);
        CHECK(difference_of(before, after) == "locked group 7");
        REQUIRE(work.change_settings(difference_of(before, after), after));
    }
    Work work(ANNOTATED_SIZE, ANNOTATED_TYPE);
    work.open(files);
    const auto locked = [&] {
        Session seen;
        set_lasting_settings(seen, work.settings());
        return locked_groups(seen.groups);
    };
    CHECK(locked() == GroupSet(0b10000110));
    CHECK(work.undo()->label == "locked group 7");
    CHECK(locked() == GroupSet(0b110));
    work.redo();
    CHECK(locked() == GroupSet(0b10000110));
}

TEST_CASE("groups of a journal that knows no locks are read without any")
{
    Session session = parse(GROUPS);
    set_lasting_settings(session, {{"groups", R"({"1":{"visible":true,"name":"aorta"}})"}});
    CHECK(locked_groups(session.groups).none());
    CHECK(session.groups.at(1).name == "aorta");
}

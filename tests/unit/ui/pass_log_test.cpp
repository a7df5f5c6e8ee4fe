// Times of passes over frames, and against a run that was saved.

#include "engine/workbench/lists/pass_log.h"

#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

TEST_CASE("the graph holds what was added from frame to frame, and begins anew with another picture")
{
    PassLog log;
    log.note(1.0, {{"raycast", 2, 3.0, 2.0}});
    log.note(1.5, {{"raycast", 5, 10.0, 4.0}, {"encode", 1, 0.5, 0.5}});
    log.note(2.0, {{"raycast", 5, 10.0, 4.0}, {"encode", 1, 0.5, 0.5}});
    log.note(2.5, {{"raycast", 1, 1.5, 1.5}});
    CHECK(log.graph("raycast") == std::vector<float>{3.0f, 7.0f, 0.0f, 1.5f});
    CHECK(log.graph() == std::vector<float>{3.0f, 7.5f, 0.0f, 1.5f});
    CHECK(log.seconds() == 1.5);
    CHECK(log.passes().size() == 1);
    log.set_frozen(true);
    log.note(3.0, {});
    CHECK(log.graph().size() == 4);
    log.set_frozen(false);
    for (size_t frame = 0; frame < 2 * PassLog::MAX_FRAMES; ++frame) log.note(4.0, {});
    CHECK(log.graph().size() == PassLog::MAX_FRAMES);
}

TEST_CASE("a run is written and read again, and so is what shvr profile prints")
{
    const TemporaryFolder folder;
    const std::vector<View::PassTime> passes{{"raycast", 7, 12.5, 4.25}, {"encode", 7, 0.5, 0.125}};
    save_pass_run(folder.path / "run.json", passes);
    const PassRun run = read_pass_run(folder.path / "run.json");
    CHECK(run.name == "run.json");
    CHECK_FALSE(run.is_of_profile);
    REQUIRE(run.passes.size() == 2);
    CHECK(run.passes[0].name == "raycast");
    CHECK(run.passes[0].runs == 7);
    CHECK(run.passes[0].total_ms == 12.5);
    CHECK(run.passes[1].longest_ms == 0.125);
    folder.write(
        "profile.json",
        R"({"driver":"d","passes":[{"name":"raycast","count":20,"median_ms":6.25},{"name":"saturation","count":20,"median_ms":null}]})");
    const PassRun profile = read_pass_run(folder.path / "profile.json");
    CHECK(profile.is_of_profile);
    CHECK(profile.find("raycast")->total_ms == 6.25);
    CHECK(profile.find("saturation")->total_ms == 0.0);
    CHECK(profile.find("encode") == nullptr);
    CHECK(change_in_words({"raycast", 1, 12.5, 12.5}, profile) == "x 2.00");
    CHECK(change_in_words({"encode", 1, 12.5, 12.5}, profile) == "");
    CHECK(change_in_words({"saturation", 1, 12.5, 12.5}, profile) == "tiny");
}

TEST_CASE("a file that holds no passes is refused, with its name and what was expected")
{
    const TemporaryFolder folder;
    folder.write("other.json", R"({"points": []})");
    folder.write("broken.json", "{");
    for (const char* name : {"other.json", "broken.json", "missing.json"}) {
        const std::string said = error_of([&] { read_pass_run(folder.path / name); });
        CHECK_MESSAGE(contains(said, name), said);
    }
}

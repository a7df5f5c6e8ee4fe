// Addresses of volumes where a person types them, and where the window writes them down.

#include <doctest/doctest.h>

#include "engine/base/file.h"
#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/bindings/palette.h"
#include "engine/workbench/bindings/preferences_file.h"
#include "tests/support/model_world.h"
#include "tests/support/volume_files.h"
#include "ui/files/file_list.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

const std::string ADDRESS = "https://host/scan.zarr", SECRET = "sig=Secret";

}  // namespace

TEST_CASE("addresses: the palette opens one that is typed, and its entry lacks the query")
{
    World world;
    const auto first = [&](const std::string& text) { return palette_entries(world.model, text).front(); };
    const PaletteEntry entry = first(ADDRESS + "?" + SECRET);
    CHECK(entry.name == "Open " + ADDRESS);
    CHECK(entry.why_not.empty());
    REQUIRE(entry.action);
    CHECK(entry.action->as<Open>()->path == ADDRESS);
    CHECK(first("s3://bucket/a key").action->as<Open>()->path == "s3://bucket/a key");
    const PaletteEntry refused = first("https://me:Secret@host/x");
    CHECK_FALSE(refused.action);
    CHECK(refused.why_not.find("a name or a password") != std::string::npos);
    CHECK((refused.name + refused.why_not).find("Secret") == std::string::npos);
    CHECK(first("open path=" + ADDRESS).action->as<Open>()->path == ADDRESS);
}

TEST_CASE("addresses: the chooser knows them from paths")
{
    CHECK(is_typed_address(" " + ADDRESS));
    CHECK(is_typed_address("s3://bucket/key"));
    CHECK_FALSE(is_typed_address("/scans/https/x.zarr"));
    CHECK(typed_address(ADDRESS + "?" + SECRET) == ADDRESS);
    CHECK(error_of([] { typed_address("ftp://host/x.zarr"); }).find("ftp") != std::string::npos);
    CHECK(without_query(ADDRESS + "?" + SECRET) == ADDRESS);
    CHECK(without_query(ADDRESS + "?" + SECRET + " and more") == ADDRESS);
    CHECK(without_query("/scans/a?b") == "/scans/a?b");
    CHECK(places(ADDRESS, {"s3://bucket/key", "/scans/x.nrrd"}).size() == 2);
}

TEST_CASE("a project is listed once, however it was opened")
{
    Preferences preferences;
    preferences.recent = {"/scans/leaf-project/", "/scans/leaf-project"};  // as an earlier version kept them
    for (const char* path : {"/scans/a.nrrd", "/scans/leaf-project/shvr/session.json", "/scans/b.session.json"})
        preferences.note_opened(path);
    CHECK(preferences.recent ==
          std::vector<std::filesystem::path>{"/scans/b.session.json", "/scans/leaf-project", "/scans/a.nrrd"});
}

TEST_CASE("addresses: the list of what was opened keeps them, and the log of actions keeps no query")
{
    Preferences preferences;
    preferences.note_opened(ADDRESS);
    CHECK(preferences.recent == std::vector<std::filesystem::path>{ADDRESS});
    TemporaryFolder folder;
    save_preferences(folder.path / "preferences.json", preferences);
    CHECK(load_preferences(folder.path / "preferences.json").recent == preferences.recent);
    const std::string typed = ADDRESS + "?" + SECRET;
    ImportTask import;
    import.volume = typed;
    for (const Action& action :
         {Action(Open{typed}), Action(TakeFile{typed}), Action(LookAtFile{typed}), Action(import)}) {
        const std::string line = line_of(action);
        CHECK(line.find(ADDRESS) != std::string::npos);
        CHECK(line.find("Secret") == std::string::npos);
    }
}

TEST_CASE("addresses: a volume on another machine is not edited, and its copy needs a name")
{
    World world;
    world.model.remote = ADDRESS;
    CHECK(why_not(world.model, Action(SaveOp{})).find("import it as a project") != std::string::npos);
    CHECK(why_not(world.model, Action(WorkOnCopy{})).find("expected path") != std::string::npos);
    CHECK(why_not(world.model, Action(WorkOnCopy{"/tmp/mine.json"})).empty());
}

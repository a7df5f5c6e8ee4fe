// What a cancelled import has left: found, measured, and deleted; anything else is left alone.

#include "engine/tasks/unfinished_import.h"

#include <fstream>

#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/projects/part_folder.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

TEST_CASE("what an import has left is measured, unless a process works on it, and deleted on request")
{
    const TemporaryFolder folder;
    const std::filesystem::path project = folder.path / "project", part = folder.path / "project.part";
    CHECK_FALSE(unfinished_import(project));
    CHECK_FALSE(unfinished_import(""));
    CHECK_FALSE(std::filesystem::exists(part));
    {
        const PartFolder held(project, false);
        std::filesystem::create_directories(part / "0");
        std::ofstream(part / "shvr" / "import.state") << "12345";
        std::ofstream(part / "0" / "0") << std::string(1000, 'x');
        CHECK_FALSE(unfinished_import(project));  // this process works on it
        CHECK_THROWS_AS(delete_unfinished_import(project), Error);
    }
    const std::optional<UnfinishedImport> found = unfinished_import(project);
    REQUIRE(found);
    CHECK(found->part == part);
    CHECK(found->bytes == 1005.0);
    delete_unfinished_import(project);
    CHECK_FALSE(std::filesystem::exists(part));
    delete_unfinished_import(project);  // there is nothing any more
}

TEST_CASE("a folder that no import has left is neither offered nor deleted")
{
    const TemporaryFolder folder;
    const std::filesystem::path part = folder.path / "project.part";
    std::filesystem::create_directories(part);
    std::ofstream(part / "mine.txt") << "work";
    CHECK_FALSE(unfinished_import(folder.path / "project"));
    CHECK_THROWS_AS(delete_unfinished_import(folder.path / "project"), Error);
    CHECK(std::filesystem::exists(part / "mine.txt"));
}

// Folders that appear complete or not at all.

#include "engine/projects/atomic_folder.h"

#include <doctest/doctest.h>

#include "engine/projects/part_folder.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

void write(const AtomicFolder& folder, const char* name, std::string_view text)
{
    write_part_file(folder.path() / name, std::as_bytes(std::span(text)));
}

std::string names_in(const fs::path& folder)
{
    std::string names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) names += entry.path().filename().string();
    return names;
}

}  // namespace

TEST_CASE("a folder is new at once, replaces the old one as a whole, and leaves nothing beside it")
{
    const TemporaryFolder folder;
    const fs::path target = folder.path / "deep" / "a.zarr";
    {
        AtomicFolder first(target);
        write(first, "one", "1");
        CHECK_FALSE(fs::exists(target));
        first.commit("one");
    }
    CHECK(bytes_of_file(target / "one") == "1");
    AtomicFolder second(target / "");
    write(second, "0/two", "2");
    CHECK(names_in(target) == "one");
    second.commit("0/two");
    CHECK(names_in(target) == "0");
    CHECK(bytes_of_file(target / "0" / "two") == "2");
    CHECK(names_in(target.parent_path()) == "a.zarr");
}

TEST_CASE("a folder that is not committed changes nothing; what a killed process left is cleared")
{
    const TemporaryFolder folder;
    const fs::path target = folder.path / "a.zarr", left = folder.path / ".a.zarr.shvr-part";
    AtomicFolder(target).commit("");
    {
        const AtomicFolder dropped(target);
        write(dropped, "one", "1");
    }
    CHECK(names_in(folder.path) == "a.zarr");
    CHECK(fs::is_empty(target));
    fs::create_directories(left / "new" / "0");
    folder.write(".a.zarr.shvr-part/new/0/half", "ha");
    AtomicFolder next(target);
    CHECK(fs::is_empty(next.path()));
    write(next, "one", "1");
    next.commit("one");
    CHECK(names_in(folder.path) == "a.zarr");
    CHECK(names_in(target) == "one");
}

TEST_CASE("what a killed process left is cleared by an opening, and what another one writes is not")
{
    const TemporaryFolder folder;
    const fs::path target = folder.path / "a.zarr", left = folder.path / ".a.zarr.shvr-part";
    clear_remains(target);  // there is nothing
    fs::create_directories(left / "new" / "0");
    clear_remains(target / "");
    CHECK_FALSE(fs::exists(left));
    AtomicFolder writing(target);
    write(writing, "one", "1");
    clear_remains(target);
    writing.commit("one");
    CHECK(names_in(target) == "one");
}

TEST_CASE("a link to a folder stays, and the folder that it leads to is replaced")
{
    const TemporaryFolder folder;
    const fs::path target = folder.path / "elsewhere" / "a.zarr", link = folder.path / "b.zarr";
    AtomicFolder(target).commit("");
    fs::create_directory_symlink(target, link);
    AtomicFolder second(link);
    write(second, "one", "1");
    second.commit("one");
    CHECK(fs::read_symlink(link) == target);
    CHECK(names_in(target) == "one");
    CHECK(names_in(target.parent_path()) == "a.zarr");
}

// Kind (annotation files): a project that is moved while it is saved.
TEST_CASE("a folder that was moved while it was written is not made again at its old place")
{
    const TemporaryFolder folder;
    const fs::path target = folder.path / "project" / "labels" / "a.zarr", moved = folder.path / "elsewhere";
    fs::create_directory(folder.path / "project");
    {
        AtomicFolder first(target);
        write(first, "one", "1");
        first.commit("one");
    }
    {
        AtomicFolder second(target);
        write(second, "two", "2");
        fs::rename(folder.path / "project", moved);
        write(second, "0/three", "3");
        CHECK(contains(error_of([&] { second.commit("two"); }), target.string() + ": was moved or removed while"));
    }
    CHECK(names_in(folder.path) == "elsewhere");
    CHECK(names_in(moved / "labels" / "a.zarr") == "one");
    // The same before anything was written at the old place.
    AtomicFolder third(moved / "labels" / "a.zarr");
    fs::rename(moved, folder.path / "project");
    CHECK(contains(error_of([&] { third.commit("two"); }), "was moved or removed"));
    CHECK(names_in(folder.path) == "project");
}

TEST_CASE("two writers of one folder: the second is refused, and the first goes on")
{
    const TemporaryFolder folder;
    const fs::path target = folder.path / "a.zarr";
    AtomicFolder first(target);
    CHECK(error_of([&] { const AtomicFolder second(target); }) ==
          target.string() + ": another process is writing it; expected no other: wait until it ends");
    write(first, "one", "1");
    first.commit("one");
    CHECK(names_in(target) == "one");
}

TEST_CASE("a place that cannot be written is refused with the target's path")
{
    const TemporaryFolder folder;
    folder.write("file", "text");
    CHECK(contains(error_of([&] { const AtomicFolder below(folder.path / "file" / "a.zarr"); }), "/file"));
}

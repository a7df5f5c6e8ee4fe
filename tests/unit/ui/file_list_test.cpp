// The model of the file chooser: what a folder shows, and what a typed path means.

#include "ui/files/file_list.h"

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <future>
#include <thread>

#include <sys/stat.h>
#include <unistd.h>

#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/formats/open_volume.h"
#include "tests/support/volume_files.h"
#include "ui/files/asked.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

using Names = std::vector<std::string>;

void touch(const std::filesystem::path& path, const std::string& text = "x")
{
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << text;
}

Names rows_of(const FileList& list)
{
    Names names;
    for (size_t row = 0; row < list.size(); ++row) names.push_back(list.at(row).name);
    return names;
}

/// Names, and what was asked about them.
void read_all(FileList& list)
{
    do {
        std::this_thread::yield();
        list.read_on();
    } while (list.is_waiting());
}

Names listed(const std::filesystem::path& folder, bool all_files, bool hidden, size_t at_once = 4096)
{
    FileList list;
    list.show(all_files, hidden);
    list.enter(folder, at_once);
    read_all(list);
    CHECK(list.failure() == "");
    return rows_of(list);
}

}  // namespace

TEST_CASE("a folder is listed with folders first, and numbers in names count as numbers")
{
    const TemporaryFolder folder;
    for (const char* name : {"slice10.tif", "slice2.tif", "Slice1.tif", "slice02.tif", "b/in", "a10/in", "a9/in",
                             ".hidden.tif", ".git/in", "notes.txt", "scan.json", "IM0001", "scan.mask.json"})
        touch(folder.path / name);
    const Names seen = {"a9",         "a10",         "b",          "IM0001",     "scan.json",
                        "Slice1.tif", "slice02.tif", "slice2.tif", "slice10.tif"};
    CHECK(listed(folder.path, false, false) == seen);
    // In whatever parts it is read.
    CHECK(listed(folder.path, false, false, 1) == seen);
    CHECK(listed(folder.path, true, true) == Names{".git", "a9", "a10", "b", ".hidden.tif", "IM0001", "notes.txt",
                                                   "scan.json", "scan.mask.json", "Slice1.tif", "slice02.tif",
                                                   "slice2.tif", "slice10.tif"});
    FileList list;
    list.enter(folder.path);
    read_all(list);
    CHECK(list.left_out() == 4);
    CHECK(list.row_of("slice2.tif") == 7);
    CHECK_FALSE(list.row_of("notes.txt"));
    CHECK(list.row_beginning("S", 0) == 4);  // scan.json
    CHECK(list.row_beginning("s", 5) == 5);  // the next
    CHECK(list.row_beginning("a", 5) == 0);  // from the top again
    CHECK_FALSE(list.row_beginning("z", 0));
    list.show(true, false);
    CHECK(list.row_of("notes.txt") == 4);
}

TEST_CASE("names are ordered as people count")
{
    CHECK(is_naturally_before("a2b", "a10b"));
    CHECK(is_naturally_before("a99999999999999999999998", "a99999999999999999999999"));
    CHECK(is_naturally_before("a", "a1"));
    CHECK(is_naturally_before("A1", "a2"));
    CHECK(is_naturally_before("B", "b"));
    CHECK(is_naturally_before("a0", "a00"));
    CHECK_FALSE(is_naturally_before("a00", "a0"));
    CHECK_FALSE(is_naturally_before("same", "same"));
}

TEST_CASE("what a file is, is told by its name, and for folders and .json by a look into them")
{
    const TemporaryFolder folder;
    const auto kind = [&](const char* name) { return details_of(folder.path / name).kind; };
    const auto text = [&](const char* name) { return details_of(folder.path / name).kind_text; };
    touch(folder.path / "scan.nii.gz", "twelve bytes");
    touch(folder.path / "session.json", R"({"shvr_session": 1})");
    touch(folder.path / "raw.json", R"({"size": 1})");
    touch(folder.path / "paint.mask.json", R"({"size": 1})");
    for (const char* name : {"paint.mask", "tree.SWC", "notes.txt", "series/1.dcm", "series/2.dcm", "series/README",
                             "slices/a1.tif", "slices/a2.TIFF", "one/a.tif", "scan.zarr/.zattrs", "v3/zarr.json",
                             "project/.zattrs", "project/shvr/session.json"})
        touch(folder.path / name);
    CHECK(kind("scan.nii.gz") == FileKind::volume);
    CHECK(text("scan.nii.gz") == "NIfTI");
    CHECK(details_of(folder.path / "scan.nii.gz").bytes == 12);
    CHECK(details_of(folder.path / "scan.nii.gz").changed.size() == 16);
    CHECK(kind("session.json") == FileKind::session);
    CHECK(kind("raw.json") == FileKind::other);
    CHECK(kind("paint.mask") == FileKind::annotation);
    CHECK(kind("paint.mask.json") == FileKind::annotation);
    CHECK(kind("tree.SWC") == FileKind::annotation);
    CHECK(kind("notes.txt") == FileKind::other);
    CHECK(kind("series") == FileKind::dicom_series);
    CHECK(kind("slices") == FileKind::slices);
    CHECK(kind("one") == FileKind::folder);
    CHECK(kind("scan.zarr") == FileKind::zarr);
    CHECK(kind("v3") == FileKind::zarr);
    CHECK(kind("project") == FileKind::project);
    CHECK(text("project") == "SHVR project");
    CHECK_FALSE(details_of(folder.path / "project").bytes);
    CHECK(is_opened_whole(FileKind::slices));
    CHECK_FALSE(is_opened_whole(FileKind::folder));
    CHECK(size_text(999) == "999 B");
    CHECK(size_text(1'400'000'000) == "1.4 GB");
    CHECK(size_text(999'999) == "1.0 MB");
    CHECK(size_text(123'456) == "123 kB");
}

TEST_CASE("endings that the chooser offers are those that readers answer to")
{
    const TemporaryFolder folder;
    for (const char* ending :
         {".tif", ".tiff", ".nrrd", ".nhdr", ".mhd", ".mha", ".nii", ".nii.gz", ".raw", ".zip", ".ozx"}) {
        CAPTURE(ending);
        const std::string name = std::string("scan") + ending;
        CHECK(is_volume_name(name));
        touch(folder.path / name, "none of these");
        std::string said;
        try {
            open_volume(folder.path / name);
        } catch (const Error& error) {
            said = error.what();
        }
        CHECK(said != "");
        CHECK(said.find("no format known") == std::string::npos);
    }
    CHECK(format_of_name("SCAN.NII.GZ") == "NIfTI");
    CHECK(format_of_name("scan.txt") == "");
    CHECK(format_of_name(".tif") == "");
    // Dialogs name each format that has such an ending and states the size of its volume.
    for (const char* name : {"a.tif", "a.nrrd", "a.mhd", "a.nii", "a.dcm", "a.ozx"})
        CHECK(names_of_formats("or").find(format_of_name(name)) != std::string::npos);
}

TEST_CASE("a folder that cannot be listed says why in one sentence, and stays the folder")
{
    const TemporaryFolder folder;
    FileList list;
    list.enter(folder.path / "gone");
    read_all(list);
    CHECK(list.failure() == (folder.path / "gone").string() + ": cannot be listed: it is not there");
    CHECK_FALSE(list.read_on());
    CHECK(list.size() == 0);
    CHECK(list.folder() == folder.path / "gone");
    touch(folder.path / "file");
    list.enter(folder.path / "file");
    read_all(list);
    CHECK(list.failure() == (folder.path / "file").string() + ": cannot be listed: it is no folder");
    list.enter(folder.path);
    read_all(list);
    CHECK(list.failure() == "");
    if (geteuid() == 0) return;  // root may read everything
    std::filesystem::create_directory(folder.path / "closed");
    chmod((folder.path / "closed").c_str(), 0);
    list.enter(folder.path / "closed");
    read_all(list);
    CHECK(list.failure() == (folder.path / "closed").string() + ": cannot be listed: it may not be read");
    chmod((folder.path / "closed").c_str(), 0700);
}

TEST_CASE("a folder of many slices is read in parts, in order at all times, and nothing else is asked about them")
{
    const TemporaryFolder folder;
    constexpr int SLICES = 20'000;
    for (int i = 0; i < SLICES; ++i) touch(folder.path / ("slice" + std::to_string(i) + ".tif"), "");
    FileList list;
    list.enter(folder.path);
    while (list.is_reading()) {
        for (size_t row = 1; row < list.size(); row += 97)
            CHECK(is_naturally_before(list.at(row - 1).name, list.at(row).name));
        list.read_on();
    }
    REQUIRE(list.size() == SLICES);
    for (int i = 0; i < SLICES; i += 999) CHECK(list.at(size_t(i)).name == "slice" + std::to_string(i) + ".tif");
    // A row is asked about when it is shown, once.
    std::filesystem::remove(folder.path / "slice0.tif");
    CHECK_FALSE(list.details(0).bytes);
    CHECK_FALSE(list.details(1).bytes);  // not known yet
    CHECK(list.is_waiting());
    read_all(list);
    CHECK_FALSE(list.details(0).bytes);
    CHECK(list.details(1).bytes == 0);
    touch(folder.path / "slice1.tif", "grown");
    CHECK(list.details(1).bytes == 0);
    CHECK_FALSE(list.is_waiting());
}

TEST_CASE("a path is taken, looked into, or refused in a sentence, by what is wanted")
{
    const TemporaryFolder folder;
    for (const char* name : {"scan.nrrd", "series/1.dcm", "series/2.dcm", "plain/in", "archive.ozx"})
        touch(folder.path / name);
    const auto verdict = [&](const char* name, Wanted wanted, bool enters = true) {
        return verdict_on(folder.path / name, wanted, enters);
    };
    const auto said = [&](const char* name, const char* what) { return (folder.path / name).string() + ": " + what; };
    CHECK(verdict("scan.nrrd", Wanted::scan).failure == "");
    CHECK_FALSE(verdict("series", Wanted::scan).enters);
    CHECK(verdict("plain", Wanted::scan, false).enters);
    CHECK(verdict("gone.nrrd", Wanted::scan).failure == said("gone.nrrd", "there is no such file or folder"));
    CHECK(verdict("archive.ozx/0", Wanted::scan).failure == "");
    CHECK(verdict("plain", Wanted::new_file, false).enters);
    CHECK(verdict("scan.nrrd", Wanted::new_file).failure == said("scan.nrrd", "is there already; type another name"));
    CHECK(verdict("new.json", Wanted::new_file).failure == "");
    CHECK(verdict("gone/new.json", Wanted::new_file).failure == said("gone", "is no folder; choose one for the file"));
    CHECK(verdict("scan.nrrd", Wanted::file).failure == "");
    CHECK(verdict("plain", Wanted::file, false).enters);
    CHECK(verdict("gone.mask", Wanted::file).failure == said("gone.mask", "there is no such file"));
    CHECK(verdict("series", Wanted::any).enters);
    CHECK_FALSE(verdict("series", Wanted::any, false).enters);
}

TEST_CASE("nobody waits for what does not answer: it is known later, or never")
{
    std::promise<void> goes_on;
    const auto wait = goes_on.get_future().share();
    Asked<int> asked([wait] {
        wait.wait();
        return 7;
    });
    CHECK(asked.is_pending());
    CHECK_FALSE(asked.take(std::chrono::milliseconds(1)));
    Asked<int> forgotten = asked;
    forgotten = {};
    CHECK_FALSE(forgotten.is_pending());
    goes_on.set_value();
    std::optional<int> answer;
    while (!answer) answer = asked.take(std::chrono::milliseconds(100));
    CHECK(answer == 7);
    CHECK_FALSE(asked.is_pending());
    CHECK_FALSE(asked.take());
}

TEST_CASE("a typed path leads from the folder that is shown")
{
    const char* const home = std::getenv("HOME");
    const std::string kept = home ? home : "";
    setenv("HOME", "/home/ada", 1);
    const std::filesystem::path folder = "/data/scans";
    CHECK(typed_path("a.tif", folder) == "/data/scans/a.tif");
    CHECK(typed_path("  '/tmp/a b.tif' ", folder) == "/tmp/a b.tif");
    CHECK(typed_path("file:///tmp/a.tif", folder) == "/tmp/a.tif");
    CHECK(typed_path("../b/", folder) == "/data/b");
    CHECK(typed_path("..", folder) == "/data");
    CHECK(typed_path("", folder) == "/data/scans");
    CHECK(typed_path("/", folder) == "/");
    CHECK(typed_path("/..", folder) == "/");
    CHECK(typed_path("~", folder) == "/home/ada");
    CHECK(typed_path("~/x", folder) == "/home/ada/x");
    CHECK(typed_path("~x", folder) == "/data/scans/~x");
    const std::vector<std::filesystem::path> recent = {"/data/scans/a.tif", "/data/scans/b.tif", "/home/ada/c.nrrd",
                                                       "/x/y"};
    Names names;
    for (const Place& place : places("/w/fern.zarr/shvr/session.json", recent))
        names.push_back(place.name + " " + place.folder.string());
    CHECK(names == Names{"Home /home/ada", "w /w", "scans /data/scans", "x /x"});
    CHECK(places({}, {}).size() == 1);
    setenv("HOME", "relative", 1);
    CHECK(home_folder() == "/");
    home ? setenv("HOME", kept.c_str(), 1) : unsetenv("HOME");
}

TEST_CASE("a path is completed as far as all names agree")
{
    const TemporaryFolder folder;
    for (const char* name : {"slice1.tif", "slice2.tif", "Other/in", ".config/in"}) touch(folder.path / name);
    const std::string whole = folder.path.string() + "/";
    CHECK(completed("sl", folder.path) == "slice");
    CHECK(completed(whole + "sl", "/") == whole + "slice");
    CHECK(completed("slice2", folder.path) == "slice2.tif");
    CHECK(completed("O", folder.path) == "Other/");
    CHECK(completed("Other/", folder.path) == "Other/in");
    CHECK(completed(".c", folder.path) == ".config/");
    CHECK(completed("zzz", folder.path) == "zzz");
    CHECK(completed("gone/a", folder.path) == "gone/a");
    CHECK(completed("..", folder.path) == "../");
    CHECK(completed("~", folder.path) == "~/");
}

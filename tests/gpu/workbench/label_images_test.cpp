// Masks and label images: distinguished from scans by what they state and hold, asked about, previewed before loading.

#include <doctest/doctest.h>

#include "engine/base/file.h"
#include "tests/gpu/workbench/desk_of_files.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

TEST_CASE_FIXTURE(OnDevice, "a mask is not taken for a scan: it is loaded, refused with both sizes, or asked about")
{
    FilesDesk desk(renderer());
    desk.open("scan.nrrd");
    desk.bench.perform(
        PaintOp{.brush = Brush::fill, .group = 3, .threshold = 100, .radius_voxels = 5, .path = {{12, 10, 8}}});
    desk.bench.perform(PaintOp{.brush = Brush::fill,
                               .radius_voxels = 3,
                               .path = {{12, 10, 8}},
                               .density = DensityBrush{.offset = 40},
                               .paints_group = false});
    const int64_t painted = desk.bench.model().voxels_by_group[3];
    REQUIRE(painted > 0);
    ExportTask task;
    task.mask = desk.path("mask.nrrd");
    task.offset = desk.path("offsets.nrrd");
    desk.bench.perform(task);
    settle(desk.bench);
    task = {};
    task.mask = desk.path("mask.tif");
    desk.bench.perform(task);
    settle(desk.bench);
    task.mask = desk.path("labels.zarr");
    desk.bench.perform(task);
    settle(desk.bench);
    const auto scan_is_open = [&] { return desk.bench.document().session.volume_path.filename() == "scan.nrrd"; };
    const auto perform = [&](const Action& action) {
        desk.bench.perform(action);
        settle(desk.bench);
        CHECK(scan_is_open());
    };
    const auto erase = [&] {
        perform(PaintOp{.brush = Brush::fill, .group = 0, .threshold = 0, .radius_voxels = 30, .path = {{12, 10, 8}}});
        CHECK(desk.bench.model().voxels_by_group[3] == 0);
    };
    const std::string shrunk = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 12 20 16\nencoding: raw\n";
    desk.folder.write("small.nrrd", shrunk + "\n" + std::string(12 * 20 * 16, '\1'));
    desk.folder.write("small-mask.nrrd", shrunk + "shvr_content:=mask\n\n" + std::string(12 * 20 * 16, '\1'));
    desk.folder.write("small.mask", std::string(12 * 20 * 16, '\1'));
    std::string foreign = bytes_of_file(desk.path("mask.tif"));
    foreign.replace(foreign.find("shvr_content="), 12, "other_key123");
    desk.folder.write("foreign.tif", foreign);
    for (const bool is_dropped : {false, true}) {
        CAPTURE(is_dropped);
        const auto take = [&](const char* name) {
            if (is_dropped) return perform(TakeFile{.path = desk.path(name)});
            perform(LoadAnnotation{.path = desk.path(name)});
        };
        for (const char* name : {"mask.nrrd", "mask.tif", "labels.zarr"}) {
            CAPTURE(name);
            erase();
            take(name);
            CHECK(desk.bench.model().voxels_by_group[3] == painted);
            CHECK(desk.bench.model().unclear_file == nullptr);
            perform(UndoOp{1});
            CHECK(desk.bench.model().voxels_by_group[3] == 0);
        }
        take("offsets.nrrd");
        CHECK(desk.said("The scan already has the density offsets of"));
        // A TIFF of another program states nothing: by intent it is a mask, dropped it may be another scan.
        take("foreign.tif");
        if (is_dropped) {
            REQUIRE(desk.bench.model().unclear_file);
            CHECK(desk.bench.model().unclear_file->path == desk.path("foreign.tif"));
            CHECK(desk.bench.model().unclear_file->may_be_scan);
            CHECK(desk.bench.model().voxels_by_group[3] == 0);
            perform(DismissUnclearFile{});
            CHECK(desk.bench.model().unclear_file == nullptr);
            take("foreign.tif");
            perform(TakeFile{.path = desk.path("foreign.tif"), .use = FileUse::mask});
        }
        CHECK(desk.bench.model().unclear_file == nullptr);
        CHECK(desk.bench.model().voxels_by_group[3] == painted);
        for (const char* name : {"small-mask.nrrd", "small.mask", "small.nrrd"}) {
            if (is_dropped && std::string(name) == "small.nrrd") continue;  // another scan, by what it states
            CAPTURE(name);
            take(name);
            CHECK(desk.bench.messages().all().back().weight == Weight::error);
            const std::string last = desk.bench.messages().all().back().text;
            CAPTURE(last);
            CHECK(last.find("expected") != std::string::npos);
            const bool has_sizes = last.find("12 20 16") != std::string::npos || last.find("3840") != std::string::npos;
            CHECK(has_sizes);
            CHECK(desk.bench.model().voxels_by_group[3] == painted);
        }
    }
    // Floats may be offsets or a mask of another program; by intent they are no scan.
    std::string floats = "NRRD0004\ntype: float\ndimension: 3\nsizes: 24 20 16\nencoding: raw\nendian: little\n\n";
    desk.folder.write("floats.nrrd", floats + std::string(size_t{4} * 24 * 20 * 16, '\0'));
    perform(LoadAnnotation{.path = desk.path("floats.nrrd")});
    REQUIRE(desk.bench.model().unclear_file);
    CHECK_FALSE(desk.bench.model().unclear_file->may_be_scan);
    perform(DismissUnclearFile{});
    desk.folder.write("other.session.json", R"({"shvr_session": 1, "volume": {"path": "small.nrrd"}})");
    perform(LoadAnnotation{.path = desk.path("other.session.json")});
    CHECK(desk.said("is a session; expected a mask, density offsets, a trace, a transfer function or a mesh"));
    // Dropped again, the scan that is open is not its own mask; and what the user says counts.
    perform(TakeFile{.path = desk.path("scan.nrrd")});
    CHECK(desk.bench.model().unclear_file == nullptr);
    desk.bench.perform(TakeFile{.path = desk.path("mask.tif"), .use = FileUse::scan});
    settle(desk.bench);
    CHECK(desk.bench.document().session.volume_path.filename() == "mask.tif");
}

// Kind (Masks): a label image of another program, given as a scan
TEST_CASE_FIXTURE(OnDevice, "a label image that is opened as a scan is asked about, or reported where nothing is open")
{
    FilesDesk desk(renderer());
    const std::string header = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 24 20 16\nencoding: raw\n\n";
    std::string voxels(24 * 20 * 16, '\0');
    for (int number = 2000; number < 4000; ++number) voxels[size_t(number)] = number < 2500 ? '\1' : '\4';
    desk.folder.write("labels.nrrd", header + voxels);
    const auto scan = [&] { return desk.bench.document().session.volume_path.filename().string(); };
    const auto perform = [&](const Action& action) {
        desk.bench.perform(action);
        settle(desk.bench);
    };
    // Nothing is open: it is opened, and its scan is asked for.
    perform(Open{desk.path("labels.nrrd")});
    CHECK(scan() == "labels.nrrd");
    CHECK(desk.bench.model().looks_like_labels == "its voxels have the values 0, 1 and 4 only");
    CHECK(desk.said("it looks like a label image: its voxels have the values 0, 1 and 4 only"));
    perform(TakeFile{desk.path("scan.nrrd"), desk.path("labels.nrrd") + "\n", FileUse::scan});
    CHECK(scan() == "scan.nrrd");
    CHECK(desk.bench.model().looks_like_labels.empty());
    CHECK(desk.bench.model().voxels_by_group[1] == 500);
    CHECK(desk.bench.model().voxels_by_group[4] == 1500);
    perform(UndoOp{1});
    CHECK(desk.bench.model().voxels_by_group[4] == 0);
    // A scan is open: that stays, and the user is asked.
    perform(Open{desk.path("labels.nrrd")});
    CHECK(scan() == "scan.nrrd");
    REQUIRE(desk.bench.model().unclear_file);
    CHECK(desk.bench.model().unclear_file->why ==
          "looks like a label image: its voxels have the values 0, 1 and 4 only");
    perform(TakeFile{.path = desk.path("labels.nrrd"), .use = FileUse::scan});
    CHECK(scan() == "labels.nrrd");
    perform(DismissNotices{});
    CHECK(desk.bench.model().looks_like_labels.empty());
    // A session says that the user means it as a scan.
    desk.folder.write("mine.json", R"({"shvr_session": 1, "volume": {"path": "labels.nrrd"}})");
    perform(Open{desk.path("mine.json")});
    CHECK(scan() == "labels.nrrd");
    CHECK(desk.bench.model().unclear_file == nullptr);
    CHECK(desk.bench.model().looks_like_labels.empty());
}

TEST_CASE_FIXTURE(OnDevice, "a preview states what loading would change, loads nothing, and loading then does that")
{
    FilesDesk desk(renderer());
    desk.open("scan.nrrd");
    const auto perform = [&](const Action& action) {
        desk.bench.perform(action);
        settle(desk.bench);
    };
    std::string first(24 * 20 * 16, '\0'), second = first;
    for (int number = 1000; number < 3000; ++number) first[size_t(number)] = '\3';
    for (int number = 2000; number < 4000; ++number) second[size_t(number)] = number < 3500 ? '\3' : '\7';
    desk.folder.write("first.mask", first);
    desk.folder.write("second.mask", second);
    perform(LoadAnnotation{desk.path("first.mask")});
    REQUIRE(desk.bench.model().voxels_by_group[3] == 2000);
    const size_t steps = desk.bench.model().undoable;
    perform(PreviewLoad{desk.path("second.mask")});
    REQUIRE(desk.bench.model().load_preview);
    const LoadPreview shown = *desk.bench.model().load_preview;
    CHECK(shown.path == desk.path("second.mask"));
    CHECK(shown.part == Part::mask);
    CHECK(shown.changes == "2000 voxels change their group.");
    REQUIRE(shown.groups.size() == 2);
    CHECK(shown.groups[0] == MaskPreview::Group{.group = 3, .before = 2000, .gained = 500, .lost = 1000});
    CHECK(shown.groups[1] == MaskPreview::Group{.group = 7, .before = 0, .gained = 500, .lost = 0});
    CHECK(desk.bench.model().undoable == steps);
    CHECK(desk.bench.model().voxels_by_group[3] == 2000);
    perform(PreviewLoad{});
    CHECK(desk.bench.model().load_preview == nullptr);
    perform(PreviewLoad{desk.path("second.mask")});
    desk.folder.write("second.mask", first);  // what is loaded is what was previewed
    perform(LoadAnnotation{desk.path("second.mask"), FileUse::mask});
    CHECK(desk.bench.model().load_preview == nullptr);
    CHECK(desk.bench.model().voxels_by_group[3] == shown.groups[0].after());
    CHECK(desk.bench.model().voxels_by_group[7] == shown.groups[1].after());
    CHECK(desk.bench.model().undoable == steps + 1);
    perform(UndoOp{1});
    perform(PreviewLoad{desk.path("first.mask")});
    REQUIRE(desk.bench.model().load_preview);
    CHECK_FALSE(desk.bench.model().load_preview->changes_anything);
    CHECK(desk.bench.model().load_preview->changes == "The scan already has this mask.");
    desk.folder.write("line.txt", "-v 10, 12, 14, 1, 2\n-v 12, 12, 14, 1, 2\n-l 0, 1, 2\n");
    perform(PreviewLoad{desk.path("line.txt")});
    REQUIRE(desk.bench.model().load_preview);
    CHECK(desk.bench.model().load_preview->changes ==
          "A trace of 2 nodes and 1 internode replaces one of 0 nodes and 0 internodes.");
    desk.folder.write("look.json", R"({"points":[{"intensity":70,"opacity":0},{"intensity":210,"opacity":0.8}]})");
    perform(PreviewLoad{desk.path("look.json")});
    REQUIRE(desk.bench.model().load_preview);
    CHECK(desk.bench.model().load_preview->changes == "The transfer function would be replaced.");
    perform(LoadAnnotation{desk.path("look.json"), FileUse::look});
    CHECK(desk.said("look.json; undo takes it back"));
    CHECK(desk.bench.model().undoable == steps + 1);
    desk.folder.write("small.mask", std::string(12 * 20 * 16, '\1'));
    // What cannot be loaded is told in the preview; nothing has failed, since nothing was to be loaded.
    const auto refusal = [&](const char* name, FileUse what) {
        const uint64_t before = desk.bench.messages().count();
        perform(PreviewLoad{desk.path(name), what});
        REQUIRE(desk.bench.model().load_preview);
        CHECK(desk.bench.messages().first_after(before, Weight::error) == nullptr);
        CHECK_FALSE(desk.bench.model().load_preview->changes_anything);
        return desk.bench.model().load_preview->failure;
    };
    CHECK(refusal("small.mask", FileUse::by_contents).find("3840") != std::string::npos);
    CHECK(refusal("line.txt", FileUse::mask).find("line.txt") != std::string::npos);
    CHECK(refusal("gone.mask", FileUse::by_contents).find("gone.mask") != std::string::npos);
    desk.folder.write("floats.nrrd",
                      "NRRD0004\ntype: float\ndimension: 3\nsizes: 24 20 16\nencoding: raw\nendian: little\n\n" +
                          std::string(size_t{4} * 24 * 20 * 16, '\0'));
    CHECK(refusal("floats.nrrd", FileUse::by_contents).find("choose which") != std::string::npos);
    CHECK(desk.bench.model().load_preview->is_unclear);
    CHECK(refusal("floats.nrrd", FileUse::offsets).empty());  // zeros change nothing
}

TEST_CASE_FIXTURE(OnDevice, "annotation dropped alone is previewed, whatever states that it is annotation")
{
    FilesDesk desk(renderer());
    desk.open("scan.nrrd");
    const auto perform = [&](const Action& action) {
        desk.bench.perform(action);
        settle(desk.bench);
    };
    const auto drop = [&](const char* name, const std::string& beside = {}) {
        perform(TakeFile{.path = desk.path(name), .beside = beside, .previews = true});
    };
    const auto shown = [&] { return desk.bench.model().load_preview; };
    std::string voxels(24 * 20 * 16, '\0');
    for (int number = 1000; number < 3000; ++number) voxels[size_t(number)] = '\3';
    const std::string header = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 24 20 16\nencoding: raw\n";
    desk.folder.write("stated.nrrd", header + "shvr_content:=mask\n\n" + voxels);
    desk.folder.write("line.txt", "-v 10, 12, 14, 1, 2\n");
    desk.folder.write("look.json", R"({"points":[{"intensity":70,"opacity":0},{"intensity":210,"opacity":0.8}]})");
    for (const bool loads : {false, true}) {
        CAPTURE(loads);
        drop("stated.nrrd");
        REQUIRE(shown());
        CHECK(shown()->changes == "2000 voxels change their group.");
        REQUIRE(shown()->groups.size() == 1);
        CHECK(shown()->groups[0] == MaskPreview::Group{.group = 3, .before = 0, .gained = 2000, .lost = 0});
        CHECK(desk.bench.model().voxels_by_group[3] == 0);
        CHECK(desk.bench.model().undoable == 0);
        if (loads)
            perform(LoadAnnotation{desk.path("stated.nrrd"), FileUse::mask});
        else
            perform(PreviewLoad{});
        CHECK(shown() == nullptr);
        CHECK(desk.bench.model().voxels_by_group[3] == (loads ? 2000 : 0));
    }
    // Of several files, one is shown after the other, each with what it changes by then.
    perform(UndoOp{1});
    drop("stated.nrrd", desk.path("line.txt") + "\n" + desk.path("stated.nrrd") + "\n");
    REQUIRE(shown());
    CHECK(shown()->part == Part::mask);
    perform(LoadAnnotation{desk.path("stated.nrrd"), FileUse::mask});
    REQUIRE(shown());
    CHECK(shown()->part == Part::trace);
    CHECK(desk.bench.model().trace.nodes().empty());
    perform(PreviewLoad{});
    REQUIRE(shown());
    CHECK(shown()->changes == "The scan already has this mask.");
    perform(PreviewLoad{});
    CHECK(shown() == nullptr);
    CHECK(desk.bench.model().trace.nodes().empty());
    // A transfer function is seen at once, and changes no annotation. A preview ends with its document.
    const size_t steps = desk.bench.model().undoable;
    drop("look.json");
    CHECK(shown() == nullptr);
    CHECK(desk.bench.model().undoable == steps + 1);
    drop("line.txt");
    REQUIRE(shown());
    desk.folder.write("other.nrrd", header + "\n" + voxels);
    perform(TakeFile{.path = desk.path("other.nrrd"), .use = FileUse::scan});
    CHECK(shown() == nullptr);
}

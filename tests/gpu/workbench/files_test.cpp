// Files dropped on the window: their kinds, pictures with their sessions, and work that was recovered at opening. Label
// images and what loading annotation changes are in label_images_test.cpp.

#include <doctest/doctest.h>

#include "engine/base/file.h"
#include "engine/base/image_file.h"
#include "engine/picture/probe_look.h"
#include "engine/session/picture_session.h"
#include "tests/gpu/workbench/desk_of_files.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

TEST_CASE_FIXTURE(OnDevice, "what a file is and takes is known before it is loaded; why it cannot be opened, too")
{
    FilesDesk desk(renderer());
    const auto look = [&](const char* name, const std::string& settings) -> const Candidate& {
        desk.bench.perform(LookAtFile{desk.path(name), settings});
        settle(desk.bench);
        REQUIRE(desk.bench.model().candidate);
        return *desk.bench.model().candidate;
    };
    const Candidate& scan = look("scan.nrrd", "");
    CHECK_FALSE(desk.bench.is_open());
    CHECK(scan.kind == "Volume");
    CHECK(scan.failure == "");
    CHECK(scan.volume.size == Size3(24, 20, 16));
    CHECK(scan.volume.spacing_from == Provenance::assumed);
    CHECK_FALSE(scan.is_project);
    CHECK(scan.memory.find("on the device") != std::string::npos);
    const Candidate& typed = look("scan.nrrd", "volume.spacing=[0.5,0.5,2]\nvolume.unit=um");
    CHECK(typed.volume.spacing == glm::dvec3(0.5, 0.5, 2.0));
    CHECK(typed.volume.spacing_from == Provenance::given);
    desk.folder.write("bare.bin", std::string(60, '\5'));
    CHECK(look("bare.bin", "").failure != "");
    const Candidate& bare = look("bare.bin", "volume.raw=3x4x5:uint8:little:0");
    CHECK(bare.failure == "");
    CHECK(bare.kind == "Bare voxels");
    CHECK(look("bare.bin", "volume.raw=30x4x5:uint8:little:0").failure.find("bare.bin") != std::string::npos);
    desk.bench.perform(Open{desk.path("bare.bin"), "volume.raw=3x4x5:uint8:little:0"});
    settle(desk.bench);
    CHECK(desk.bench.model().volume.size == Size3(3, 4, 5));
    CHECK(desk.bench.model().candidate == nullptr);
}

TEST_CASE_FIXTURE(OnDevice, "a bare scan that nothing was saved of is no project that is saved")
{
    FilesDesk desk(renderer());
    desk.open("scan.nrrd");
    CHECK(saved_in_words(desk.bench.model()) == std::string("no project yet"));
    desk.bench.perform(NodeOp{.at = {10, 12, 14}, .radius_voxels = 2.0, .group = uint8_t{2}});
    CHECK(saved_in_words(desk.bench.model()) == std::string("not saved"));
    desk.bench.perform(SaveOp{});
    settle(desk.bench);
    CHECK(saved_in_words(desk.bench.model()) == std::string("saved"));
    // Near enough to be allowed, and not without a word.
    desk.bench.perform(NodeOp{.at = {10, 12, 16.5}, .radius_voxels = 2.0, .group = uint8_t{2}});
    CHECK(desk.said("it lies outside the volume"));
}

TEST_CASE_FIXTURE(OnDevice, "what cannot be opened leaves the start page, with the path and the reason")
{
    FilesDesk desk(renderer());
    desk.folder.write("broken.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 8\n\n");
    desk.bench.begin_open(desk.path("broken.nrrd"), {});
    settle(desk.bench);
    CHECK_FALSE(desk.bench.is_open());
    CHECK(desk.bench.model().open_failure.find("broken.nrrd") != std::string::npos);
    REQUIRE(desk.bench.model().failed_path);
    CHECK(*desk.bench.model().failed_path == desk.path("broken.nrrd"));
    desk.open("scan.nrrd");
    CHECK(desk.bench.is_open());
    CHECK(desk.bench.model().open_failure.empty());
}

TEST_CASE_FIXTURE(OnDevice, "what is dropped is taken by its contents, whatever its name; the rest is refused in words")
{
    FilesDesk desk(renderer());
    const auto drop = [&](const char* name) {
        desk.bench.perform(TakeFile{desk.path(name)});
        settle(desk.bench);
    };
    desk.folder.write("look", R"({"points":[{"intensity":70,"opacity":0},{"intensity":210,"opacity":0.8}]})");
    drop("look");
    CHECK(desk.said("belongs to a volume; expected that to be open"));
    drop("scan.nrrd");
    CHECK(desk.bench.model().volume.size == Size3(24, 20, 16));
    drop("look");
    CHECK(desk.said("undo takes it back"));
    CHECK(desk.bench.model().undoable == 1);
    // A kept transfer function: its positions are shares of the range of tissue, for use in any volume.
    desk.folder.write("kept.json", R"({"note":"Kept.","points":[{"at":0,"color":"#200000","opacity":0},)"
                                   R"({"at":1,"color":"#ffffe0","opacity":0.8}],"extends":false})");
    const TransferFunction before = desk.bench.model().session.transfer_function;
    drop("kept.json");
    CHECK(desk.said("kept.json; undo takes it back"));
    CHECK(desk.bench.model().session.transfer_function ==
          transfer_function_of(read_transfer_preset(desk.path("kept.json")), desk.bench.model().statistics));
    desk.bench.perform(UndoOp{1});
    CHECK(desk.bench.model().session.transfer_function == before);
    desk.folder.write("bad.json", R"({"points":[{"at":0,"colour":"#200000","opacity":0},{"at":1,"opacity":0.8}]})");
    drop("bad.json");
    CHECK(desk.said("bad.json"));
    CHECK(desk.bench.messages().all().back().weight == Weight::error);
    desk.folder.write("paint.anything", std::string(24 * 20 * 16, '\3'));
    drop("paint.anything");
    CHECK(desk.bench.model().voxels_by_group[3] == 24 * 20 * 16);
    drop("paint.anything");
    CHECK(desk.said("The scan already has the mask of"));
    desk.folder.write("line.txt", "-v 10, 12, 14, 1, 2\n");
    drop("line.txt");
    CHECK(desk.bench.model().trace.nodes().size() == 1);
    CHECK(desk.bench.model().undoable == 3);
    for (int steps = 0; steps < 3; ++steps) desk.bench.perform(UndoOp{1});
    CHECK(desk.bench.model().voxels_by_group[3] == 0);
    desk.folder.write("odd.swc", "1 1 3 4 5 1 -1\n2 1 6 4 5 1 1\n2 1 9 4 5 1 1\n");
    drop("odd.swc");
    CHECK(desk.bench.model().trace.nodes().size() == 2);
    CHECK(desk.said("odd.swc:3: sample 2 is defined twice"));  // as a warning, since the line is left out
    desk.bench.perform(UndoOp{1});
    desk.folder.write("notes.json", R"({"a": 1})");
    drop("notes.json");
    CHECK(desk.said("notes.json: is none of what can be taken; expected a volume"));
    drop("nothing.here");
    CHECK(desk.said("nothing.here"));
    desk.folder.write("session", R"({"shvr_session": 1, "volume": {"path": "scan.nrrd"}})");
    drop("session");
    CHECK(desk.bench.messages().all().back().weight == Weight::error);  // a session is one by its name, .json
}

TEST_CASE_FIXTURE(OnDevice, "annotation that is dropped with its scan goes into that, not into what is open")
{
    FilesDesk desk(renderer());
    desk.folder.write("other.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 24 20 16\nencoding: raw\n\n" +
                                        std::string(24 * 20 * 16, '\7'));
    desk.folder.write("other.mask", std::string(24 * 20 * 16, '\3'));
    desk.folder.write("other.txt", "-v 10, 12, 14, 1, 2\n");
    const auto drop = [&](const char* first, std::initializer_list<const char*> others) {
        TakeFile taken{.path = desk.path(first)};
        for (const char* other : others) taken.beside += desk.path(other) + "\n";
        desk.bench.perform(taken);
        settle(desk.bench);
    };
    for (const bool is_open_before : {false, true}) {
        CAPTURE(is_open_before);
        if (is_open_before) desk.open("scan.nrrd");
        drop("other.mask", {"other.nrrd", "other.txt"});  // in whatever order they come
        CHECK(desk.bench.document().session.volume_path.filename() == "other.nrrd");
        CHECK(desk.bench.model().voxels_by_group[3] == 24 * 20 * 16);
        CHECK(desk.bench.model().trace.nodes().size() == 1);
        desk.bench.perform(UndoOp{1});
        desk.bench.perform(UndoOp{1});
    }
    desk.open("scan.nrrd");
    CHECK(desk.bench.model().voxels_by_group[3] == 0);
    drop("other.nrrd", {"scan.nrrd", "other.mask"});
    CHECK(desk.said("each can be opened; expected one scan, session or project at a time"));
    CHECK(desk.bench.document().session.volume_path.filename() == "scan.nrrd");
    CHECK(desk.bench.model().voxels_by_group[3] == 0);
    drop("other.txt", {"other.mask"});  // both of what is open
    CHECK(desk.bench.model().voxels_by_group[3] == 24 * 20 * 16);
    CHECK(desk.bench.model().trace.nodes().size() == 1);
    desk.folder.write("broken.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 8\n\n");
    desk.folder.write("gone.session.json", R"({"shvr_session": 1, "volume": {"path": "gone.nrrd"}})");
    drop("gone.session.json", {"other.mask"});
    CHECK(desk.said("what was dropped with it is not taken either"));
}

TEST_CASE_FIXTURE(OnDevice, "a corrected spacing is saved, nodes stay at their voxels, and it is there next time")
{
    FilesDesk desk(renderer());
    desk.open("scan.nrrd");
    desk.bench.perform(NodeOp{.at = {10, 12, 14}, .radius_voxels = 2.0, .group = uint8_t{2}});
    const glm::dvec3 eye = desk.bench.model().camera.eye;
    desk.bench.perform(KeepCamera{"mine"});
    desk.bench.perform(Set{R"({"measurements":[{"from":[1,2,3],"to":[5,2,3]}]})"});
    desk.bench.perform(CorrectSpacing{{0.5, 0.5, 2.0}, "um"});
    settle(desk.bench);
    for (const bool is_again : {false, true}) {
        CAPTURE(is_again);
        if (is_again) desk.open("scan.session.json");
        CHECK(desk.bench.model().volume.spacing == glm::dvec3(0.5, 0.5, 2.0));
        CHECK(desk.bench.model().volume.unit == "um");
        REQUIRE(desk.bench.model().trace.nodes().size() == 1);
        CHECK(desk.bench.model().trace.nodes().begin()->second.position == glm::dvec3(5, 6, 28));
        CHECK(glm::distance(desk.bench.model().camera.eye, eye * glm::dvec3(0.5, 0.5, 2.0)) < 1e-9);
        const auto kept = std::get<Camera>(desk.bench.model().session.cameras.at("mine"));
        CHECK(glm::distance(kept.eye, eye * glm::dvec3(0.5, 0.5, 2.0)) < 1e-9);
        REQUIRE(desk.bench.model().measurements.size() == 1);
        CHECK(desk.bench.model().measurements[0] == Measurement{{{1, 2, 3}, {5, 2, 3}}});
    }
}

TEST_CASE_FIXTURE(OnDevice, "what was recovered at opening stays to be seen until it is dismissed")
{
    FilesDesk desk(renderer());
    desk.open("scan.nrrd");
    desk.bench.perform(NodeOp{.at = {10, 12, 14}, .radius_voxels = 2.0, .group = uint8_t{2}});
    desk.bench.perform(SaveOp{});
    settle(desk.bench);
    CHECK(desk.bench.why_not(DismissNotices{}) == "there is nothing to be dismissed");
    std::filesystem::remove_all(desk.path("scan.session.labels.zarr"));
    desk.open("scan.session.json");
    REQUIRE(desk.bench.model().recovered.size() == 1);
    CHECK(desk.bench.model().recovered[0].find("scan.session.labels.zarr: is missing") != std::string::npos);
    desk.bench.perform(NodeOp{.at = {12, 12, 14}, .radius_voxels = 2.0, .group = uint8_t{2}});
    settle(desk.bench);
    CHECK(desk.bench.model().recovered.size() == 1);
    desk.bench.perform(DismissNotices{});
    CHECK(desk.bench.model().recovered.empty());
}

TEST_CASE_FIXTURE(OnDevice, "pictures have scale bar, axes and words where that is wanted, in the picture's size")
{
    FilesDesk desk(renderer(), {200, 160});
    desk.open("scan.nrrd");
    desk.bench.perform(Set{R"({"interaction":{"screenshot_scale":3}})"});
    std::vector<Image8> pictures;
    for (const bool has_marks : {false, true})
        for (const bool is_large : {false, true}) {
            desk.bench.perform(
                Set{sentence(R"({"interaction":{"screenshot_marks":)", has_marks ? "true" : "false", "}}")});
            desk.bench.perform(Screenshot{is_large});
            settle(desk.bench);
            desk.bench.wait_for_screenshots();
            settle(desk.bench);
            pictures.push_back(
                read_png(desk.path(sentence("scan.session-view-", pictures.size() + 1, ".png").c_str())));
        }
    REQUIRE(pictures[3].width == 600);
    const auto covered = [&](size_t plain, size_t marked, double left, double right) {
        const Image8 &a = pictures[plain], &b = pictures[marked];
        size_t different = 0;
        for (int y = 0; y < a.height; ++y)
            for (int x = int(left * a.width); x < int(right * a.width); ++x) {
                const size_t at = 4 * (size_t(x) + size_t(a.width) * size_t(y));
                different += !std::equal(&a.rgba[at], &a.rgba[at] + 3, &b.rgba[at]);
            }
        return double(different);
    };
    for (const auto& [left, right] : {std::pair(0.0, 0.5), std::pair(0.5, 1.0)}) {  // axes, and the bar
        const double small = covered(0, 2, left, right), large = covered(1, 3, left, right);
        CHECK(small > 100.0);
        CHECK(small < 8000.0);
        CHECK(large / small == doctest::Approx(9.0).epsilon(0.15));
    }
}

TEST_CASE_FIXTURE(OnDevice, "a picture of the window holds its session: it is rendered again bit for bit, and opened")
{
    FilesDesk desk(renderer());
    desk.open("scan.nrrd");
    desk.bench.perform(
        PaintOp{.brush = Brush::fill, .group = 3, .threshold = 100, .radius_voxels = 5, .path = {{12, 10, 8}}});
    desk.bench.perform(Set{R"({"light":{"ambient":0.62},"transfer_function":{"points":[
        {"intensity":90,"opacity":0,"color":"#204060"},{"intensity":200,"opacity":0.6,"color":"#ffe0a0"}]}})"});
    desk.bench.perform(Orbit{40, -15});
    settle(desk.bench);
    desk.bench.perform(SaveOp{});
    desk.bench.perform(Screenshot{});
    settle(desk.bench);
    desk.bench.wait_for_screenshots();
    const std::string picture = desk.path("scan.session-view-1.png");
    const Image8 shown = read_png(picture);
    const Camera camera = desk.bench.model().camera;
    // Another look since: the picture has its own.
    desk.bench.perform(Set{R"({"light":{"ambient":0.1}})"});
    desk.bench.perform(LookFrom{"top"});
    settle(desk.bench);

    const OpenedSession opened = open_session(picture);
    CHECK(opened.pictured == desk.path("scan.session.json"));
    Renderer other({});
    other.load(opened.source, opened.statistics, opened.session.render);
    Work work(opened.source->info().size, opened.source->info().type);
    work.open({.journal = opened.session.journal_path, .volume = opened.source->info()},
              Work::Opening{.only_look = true});
    other.scene().show(work.document());
    const Camera of_picture = camera_named(opened.session, opened.session.camera_name, opened.source->info());
    CHECK(probe_of_picture(picture) == PictureProbe::point);  // the window draws a ring around it
    const RenderOptions as_shown{
        .probe =
            in_picture(shown_probe(opened.session, opened.source->info(), opened.statistics), PictureProbe::point)};
    const Image8 again = to_image8(other.render(opened.session, of_picture, as_shown).image);
    CHECK(again.width == shown.width);
    int differing = 0, most = 0;
    for (size_t i = 0; i < shown.rgba.size(); ++i) {
        differing += again.rgba[i] != shown.rgba[i];
        most = std::max(most, std::abs(int(again.rgba[i]) - int(shown.rgba[i])));
    }
    CHECK(differing == 0);
    CHECK(most == 0);

    // Opened, it shows the project as in the picture; undo takes its look back.
    desk.bench.perform(Open{picture});
    settle(desk.bench);
    CHECK(desk.bench.model().session_path == desk.path("scan.session.json"));
    CHECK(desk.bench.model().session.light.ambient == 0.62);
    CHECK(desk.bench.model().camera.eye == camera.eye);
    desk.bench.perform(UndoOp{1});
    CHECK(desk.bench.model().session.light.ambient == 0.1);
}

TEST_CASE_FIXTURE(OnDevice, "what a file offers several of can be chosen before it is opened")
{
    FilesDesk desk(renderer());
    std::string colored =
        "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 3 24 20 16\nkinds: RGB-color domain domain domain\n"
        "encoding: raw\n\n";
    for (int voxel = 0; voxel < 3 * 24 * 20 * 16; ++voxel) colored += char(voxel * 11 % 251);
    desk.folder.write("colored.nrrd", colored);
    const auto look = [&](const std::string& settings) -> const Candidate& {
        desk.bench.perform(LookAtFile{desk.path("colored.nrrd"), settings});
        settle(desk.bench);
        REQUIRE(desk.bench.model().candidate);
        return *desk.bench.model().candidate;
    };
    const Candidate several = look("");
    CHECK(several.failure.find("channels") != std::string::npos);
    REQUIRE(several.choices.size() == 1);
    CHECK(several.choices[0].key == "channel");
    CHECK(several.choices[0].values == std::vector<std::string>{"1", "2", "3"});
    CHECK(several.choices[0].titles == std::vector<std::string>{"1  red", "2  green", "3  blue"});
    const Candidate one = look("volume.channel=" + several.choices[0].values[1]);
    CHECK(one.failure == "");
    CHECK(one.choices.empty());
    CHECK(one.volume.size == Size3(24, 20, 16));
}

TEST_CASE_FIXTURE(OnDevice, "Fit says what it brings into sight")
{
    FilesDesk desk(renderer());
    desk.open("scan.nrrd");
    desk.bench.perform(FitView{});
    CHECK(desk.bench.messages().last() == "The whole volume is in view");
    desk.bench.perform(PlaceClips{1.0, 0.0});
    desk.bench.perform(FitView{});
    CHECK(desk.bench.messages().last() == "The whole volume is in view, except where the clip planes hide it");
    desk.bench.perform(PlaceClips{});
    desk.bench.perform(MoveCut{0, false, 0.25});
    desk.bench.perform(FitView{});
    CHECK(desk.bench.messages().last() == "The uncut part of the volume is in view");
}

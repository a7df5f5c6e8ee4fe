// The photographer alone: names of pictures, and a large one that ends or is cancelled.

#include <algorithm>
#include <fstream>

#include <doctest/doctest.h>

#include "engine/base/image_file.h"
#include "engine/session/looks/key_look.h"
#include "engine/session/picture_session.h"
#include "engine/workbench/actions/figure_text.h"
#include "engine/workbench/services/photographer.h"
#include "tests/gpu/workbench/services/desk_with_scan.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

struct PhotographerAlone : DeskWithScan {
    Photographer photographer{desk, {.pixels = [] { return glm::uvec2(48, 40); }, .stay_open = notes("stay_open")}};

    void finish()
    {
        const auto step = [&] {
            document().screen.advance();  // takes what changed; large pictures wait for that
            photographer.advance();
        };
        until(step, [&] { return !photographer.has_large(); });
    }
    /// What the picture shows of the present look.
    Image8 figure(const char* name)
    {
        photographer.act(FigureTask{.path = folder.path / name, .pixels = {24, 20}});
        finish();
        return read_png(folder.path / name);
    }
    void keep(const char* view)
    {
        document().session.cameras[view] = document().camera;
        document().session.key_looks[view] = key_look_of(document().session);
    }
    /// The three frames of a movie through two views.
    std::vector<Image8> frames(const char* name, const char* views)
    {
        photographer.act(MovieTask{.path = folder.path / name, .views = views, .frames = 3, .pixels = {24, 20}});
        finish();
        std::vector<Image8> frames;
        for (int index = 0; index < 3; ++index) frames.push_back(read_png(folder.path / name / frame_file(index, 3)));
        return frames;
    }
};

}  // namespace

TEST_CASE_FIXTURE(PhotographerAlone, "photographer: a large picture is a multiple of the window's, next to the session")
{
    CHECK(photographer.stem() == folder.path / "scan");
    document().session.interaction.screenshot_scale = 2;
    photographer.act(Screenshot{.is_large = true});
    CHECK(photographer.has_large());
    CHECK(says("96 x 80"));
    until([&] { photographer.advance(); }, [&] { return !photographer.has_large() && !photographer.is_writing(); });
    CHECK(std::filesystem::exists(folder.path / "scan-view-1.png"));
}

TEST_CASE_FIXTURE(PhotographerAlone, "photographer: only its own number cancels a large picture, and a stroke does")
{
    std::vector<Jobs::State> states;
    photographer.add_loading(states);
    CHECK(states.empty());
    photographer.act(Screenshot{.is_large = true});
    photographer.add_loading(states);
    REQUIRE(states.size() == 1);
    CHECK_FALSE(photographer.cancel(states[0].number + 1));
    CHECK(photographer.has_large());
    CHECK(photographer.cancel(states[0].number));
    CHECK_FALSE(photographer.has_large());
    CHECK_FALSE(photographer.cancel(states[0].number));
    photographer.act(Screenshot{.is_large = true});
    CHECK_FALSE(contains(states[0].what, "when the picture in the window is sharp"));
    states.clear();
    document().annotator.edit_trace("a node", {TraceNodeChange{0, {}, TraceNode{{20.0, 18.0, 16.0}, 4.0, 2}}});
    renderer().scene().show_surfaces({}, trace(), document().session.groups);
    photographer.add_loading(states);
    CHECK(contains(states.at(0).what, "when the picture in the window is sharp"));  // which shows no node yet
    document().annotator.begin_stroke(document().stroke());
    photographer.advance();
    CHECK_FALSE(photographer.has_large());
    CHECK(says("cancelled by painting"));
    document().annotator.end_stroke();
}

TEST_CASE_FIXTURE(PhotographerAlone,
                  "photographer: a figure has its size and its session, and is not joined by another")
{
    const std::filesystem::path path = folder.path / "a.tif";
    photographer.act(FigureTask{.path = path,
                                .pixels = {59, 30},
                                .dots_per_inch = 300.0,
                                .is_transparent = true,
                                .elements = {.has_scale_bar = true, .title = "pith"}});
    CHECK(says("A figure of 59 x 30 pixels, 5 x 2.5 mm at 300 dots per inch is drawn"));
    CHECK_THROWS_WITH(photographer.act(FigureTask{.path = folder.path / "b.png"}),
                      doctest::Contains("nother picture is being drawn"));
    until([&] { photographer.advance(); }, [&] { return !photographer.has_large(); });
    const std::optional<PictureSession> kept = session_in_picture(path);
    REQUIRE(kept);
    CHECK(kept->text.find("[59,30]") != std::string::npos);
    CHECK(kept->text.find("#ffffff00") != std::string::npos);
    const std::optional<DrawnElements> drawn = elements_in_picture(path);
    REQUIRE(drawn);
    CHECK((drawn->has_scale_bar && !drawn->has_legend && drawn->title == "pith"));
    CHECK_FALSE(std::filesystem::exists(folder.path / "b.png"));
}

TEST_CASE_FIXTURE(PhotographerAlone, "photographer: a movie turns, and a cancelled one names what is finished")
{
    const MovieTask task{.path = folder.path / "frames",
                         .turntable_degrees = 180.0,
                         .frames = 3,
                         .pixels = {24, 20},
                         .elements = {.has_axes = true}};
    photographer.act(task);
    desk.say("careful", Weight::warning);
    until([&] { photographer.advance(); }, [&] { return !photographer.has_large(); });
    const std::deque<Message>& all = desk.messages.all();
    CHECK(std::ranges::count(all, std::string("careful"), &Message::text) == 1);  // its progress is said after that
    CHECK(elements_in_picture(task.path / "frame-0002.png").value_or(DrawnElements()).has_axes);
    CHECK(says("frames (3 frames, 24 x 20 pixels)"));
    CHECK_FALSE(read_png(task.path / "frame-0001.png") == read_png(task.path / "frame-0002.png"));
    photographer.act(task);
    until([&] { photographer.advance(); },
          [&] {
              std::vector<Jobs::State> states;
              photographer.add_loading(states);
              return states.empty() || states[0].fraction > 0.34;
          });
    REQUIRE(photographer.has_large());
    CHECK(photographer.cancel(PICTURE_JOB));
    CHECK(says("frame-0001.png is finished"));
    CHECK_THROWS_AS(photographer.act(MovieTask{.path = folder.path / "m", .views = "nowhere\nfront"}), Error);
}

TEST_CASE_FIXTURE(PhotographerAlone,
                  "photographer: a movie goes from one kept look to the next, and ends with its picture")
{
    keep("whole");
    const Image8 whole = figure("whole.png");
    document().session.cut.upper.x = 20.0;
    document().session.transfer_function =
        TransferFunction({{.intensity = 40.0, .color = glm::dvec3(1.0, 0.0, 0.0), .opacity = 0.1},
                          {.intensity = 200.0, .opacity = 0.6}});
    keep("half");
    const Image8 half = figure("half.png");
    document().session.cut = {};  // what is shown while the movie is drawn does not matter
    document().session.light.ambient = 0.9;
    const std::vector<Image8> shown = frames("cut", "whole\nhalf");
    CHECK((shown[0] == whole));
    CHECK_FALSE((shown[1] == whole));
    CHECK_FALSE((shown[1] == half));
    CHECK((shown[2] == half));
    const std::optional<PictureSession> kept = session_in_picture(folder.path / "cut" / "frame-0003.png");
    REQUIRE(kept);
    CHECK(parse_session(kept->text, folder.path, "frame").cut.upper.x == 20.0);
    CHECK(document().session.cut == CutBox());
}

TEST_CASE_FIXTURE(PhotographerAlone,
                  "photographer: the trace has the colours of each look in a movie, and its own after it")
{
    document().annotator.edit_trace("a node", {TraceNodeChange{0, {}, TraceNode{{20.0, 18.0, 16.0}, 14.0, 2}}});
    renderer().scene().show_surfaces({}, trace(), document().session.groups);
    const Image8 plain = figure("plain.png");
    keep("plain");
    document().session.groups[2].color = glm::dvec3(0.0, 0.0, 1.0);
    keep("blue");
    document().session.groups.erase(2);
    const std::vector<Image8> shown = frames("trace", "plain\nblue");
    CHECK((shown[0] == plain));
    CHECK_FALSE((shown[1] == plain));
    CHECK_FALSE((shown[2] == shown[1]));
    CHECK((figure("after.png") == plain));
}

TEST_CASE_FIXTURE(PhotographerAlone, "photographer: a movie that fails keeps a window open that waits for it")
{
    const MovieTask task{.path = folder.path / "frames", .turntable_degrees = 180.0, .frames = 3, .pixels = {24, 20}};
    photographer.act(task);
    std::filesystem::remove_all(task.path);
    std::ofstream(task.path) << "a file";
    static_cast<void>(take_calls());
    until([&] { photographer.advance(); }, [&] { return !photographer.has_large(); });
    CHECK(take_calls() == "stay_open");
    CHECK(desk.messages.all().back().weight == Weight::error);
}

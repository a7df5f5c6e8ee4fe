// The viewer alone: which changes are steps, which only have to be kept, and when the picture is behind.

#include <doctest/doctest.h>

#include "engine/workbench/services/viewer.h"
#include "tests/gpu/workbench/services/desk_with_scan.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

struct ViewerAlone : DeskWithScan {
    std::optional<Session> taken;
    Viewer viewer{desk,
                  {.note_edit = notes("note_edit"),
                   .note_to_keep = notes("note_to_keep"),
                   .take_session = [this](Session session) { taken = std::move(session); }}};
};

}  // namespace

TEST_CASE_FIXTURE(ViewerAlone, "viewer: moving the camera is kept, and edits nothing; keeping a camera edits")
{
    const Camera before = document().camera;
    viewer.act(Orbit{90.0, 0.0});
    CHECK(document().camera != before);
    CHECK(take_calls() == "note_to_keep");
    viewer.act(LookFrom{"top"});
    CHECK(take_calls() == "note_to_keep");
    viewer.act(KeepCamera{});
    CHECK(take_calls() == "note_edit");
    CHECK(document().session.cameras.contains("view 1"));
    viewer.act(RenameCamera{"view 1", "stem"});
    CHECK(take_calls() == "note_edit");
    CHECK_FALSE(error_of([&] { viewer.act(ForgetCamera{"view 1"}); }).empty());
    CHECK(take_calls().empty());
}

TEST_CASE_FIXTURE(ViewerAlone,
                  "viewer: a view is kept with its look, which goes where its name goes, and is shown on request")
{
    Session& session = document().session;
    session.light.ambient = 0.8;
    viewer.act(KeepCamera{.name = {}, .with_look = true});
    CHECK(says("This view is kept as view 1, with its look; File > Movie..."));
    viewer.act(KeepCamera{});
    CHECK(session.key_looks.size() == 1);
    session.light.ambient = 0.2;
    viewer.act(LookFrom{"view 1"});
    CHECK_FALSE(taken);
    viewer.act(RenameCamera{"view 1", "stem"});
    viewer.act(LookFrom{"stem", true});
    REQUIRE(taken);
    CHECK(taken->light.ambient == 0.8);
    CHECK(contains(error_of([&] { viewer.act(LookFrom{"view 2", true}); }), "no look is kept"));
    viewer.act(KeepCamera{"stem"});  // in its place, without a look
    CHECK(session.key_looks.empty());
    viewer.act(KeepCamera{"stem", true});
    viewer.act(ForgetCamera{"stem"});
    CHECK(session.key_looks.empty());
}

TEST_CASE_FIXTURE(ViewerAlone, "viewer: cutting planes go through the settings, which it does not change itself")
{
    const Session before = document().session;
    viewer.act(MoveCut{.axis = 0, .upper = true, .share = -0.5});
    REQUIRE(taken);
    CHECK(taken->cut.upper.x == 20.0);
    CHECK((document().session == before));
    viewer.act(ResetCuts{});
    CHECK(taken->cut == CutBox{});
}

TEST_CASE_FIXTURE(ViewerAlone, "viewer: an oblique plane faces the camera, is flipped, and is removed")
{
    CHECK(contains(error_of([&] { viewer.act(CutObliquely{PlaneChange::flip}); }), "no oblique cutting plane"));
    CHECK(contains(error_of([&] { viewer.act(CutObliquely{PlaneChange::remove}); }), "no oblique cutting plane"));
    viewer.act(CutObliquely{PlaneChange::add});
    REQUIRE(taken);
    const Camera& camera = document().camera;
    const glm::dvec3 towards = glm::normalize(camera.eye - camera.target);
    CHECK(glm::distance(*taken->cut.plane_normal, towards) < 1e-12);
    document().session = *taken;
    viewer.act(CutObliquely{PlaneChange::flip});
    CHECK(*taken->cut.plane_normal == -*document().session.cut.plane_normal);
    CHECK(taken->cut.plane_point == document().session.cut.plane_point);
    viewer.act(CutObliquely{PlaneChange::remove});
    CHECK(taken->cut == CutBox{});
}

TEST_CASE_FIXTURE(ViewerAlone, "viewer: a picture is behind until the next step, and a pane has its size")
{
    CHECK_FALSE(viewer.is_stirring());
    CHECK(contains(error_of([&] { viewer.pane(0); }), "no longer has this pane"));
    viewer.act(Resize{{48, 40}});
    CHECK(viewer.is_stirring());
    viewer.advance();
    CHECK_FALSE(viewer.is_stirring());
    CHECK(viewer.pane(0).pixels() == glm::uvec2(48, 40));
    CHECK_FALSE(error_of([&] { viewer.pane(9); }).empty());
    viewer.act(Orbit{1.0, 0.0});
    CHECK(viewer.is_stirring());
    viewer.advance();
    viewer.look_again();
    CHECK(viewer.is_stirring());
}

TEST_CASE_FIXTURE(ViewerAlone, "viewer: slices follow the probe out of their plane, and the box of the cuts is brief")
{
    document().session.view.arrangement = Arrangement::slices;
    document().session.view.slices.zoom = 8.0;
    document().session.view.slices.center = glm::dvec3(20.0, 18.0, 16.0);
    viewer.act(Resize{{48, 40}});
    viewer.advance();
    take_calls();
    document().touch.place({34.0, 4.0, 28.0});
    std::vector<std::string> lines;
    desk.log = [&](const std::string& line) { lines.push_back(line); };
    viewer.advance();
    viewer.advance();
    CHECK(take_calls() == "note_to_keep");
    CHECK(lines.size() == 1);

    CHECK_FALSE(viewer.shows_cut_box());
    viewer.show_cut_box();
    CHECK(viewer.shows_cut_box());
    later_s += 2.0;
    CHECK_FALSE(viewer.shows_cut_box());
}

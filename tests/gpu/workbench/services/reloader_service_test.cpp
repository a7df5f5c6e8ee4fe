// The reloader alone: the scene is replaced in slices, or the settings return to those of the scene that is shown.

#include <doctest/doctest.h>

#include "engine/workbench/services/reloader.h"
#include "tests/gpu/workbench/services/desk_with_scan.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

struct ReloaderAlone : DeskWithScan {
    bool is_opening = false;
    Reloader reloader{desk,
                      {.is_opening = [this] { return is_opening; },
                       .opening_name = [] { return std::string_view("other.json"); },
                       .load_alone = notes("load_alone"),
                       .drop_screenshot = notes("drop_screenshot"),
                       .note_edit = notes("note_edit"),
                       .look_again = notes("look_again")}};
    /// Changes the sampling as the editor of settings does.
    void want_filtered()
    {
        const RenderSettings before = document().session.render;
        document().session.render.sampling = Sampling::hardware;
        reloader.want(before);
    }
};

}  // namespace

TEST_CASE_FIXTURE(ReloaderAlone, "reloader: the shown scene stays until the next one is loaded")
{
    const Scene* const before = &renderer().scene();
    want_filtered();
    CHECK(reloader.is_wanted());
    until([&] { reloader.advance(); }, [&] { return !reloader.is_wanted(); });
    CHECK(&renderer().scene() != before);
    CHECK(document().session.render.sampling == Sampling::hardware);
    CHECK(take_calls() == "drop_screenshot look_again");
    CHECK(says("Reloaded"));
}

TEST_CASE_FIXTURE(ReloaderAlone, "reloader: cancelled by its number, the settings are those of the shown scene")
{
    const Sampling before = document().session.render.sampling;
    const Scene* const shown = &renderer().scene();
    want_filtered();
    std::vector<Jobs::State> states;
    reloader.add_loading(states);
    REQUIRE(states.size() == 1);
    CHECK_FALSE(reloader.cancel(states[0].number + 1));
    CHECK(reloader.is_wanted());
    CHECK(reloader.cancel(states[0].number));
    CHECK(document().session.render.sampling == before);
    CHECK(take_calls() == "note_edit");
    reloader.advance();
    CHECK(&renderer().scene() == shown);
    CHECK_FALSE(reloader.cancel());
}

TEST_CASE_FIXTURE(ReloaderAlone, "reloader: nothing is reloaded while another file is opened")
{
    is_opening = true;
    CHECK(contains(error_of([&] { want_filtered(); }), "other.json is being opened"));
    CHECK_FALSE(reloader.is_wanted());
}

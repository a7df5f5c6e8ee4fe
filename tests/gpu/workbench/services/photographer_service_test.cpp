// The photographer alone: names of pictures, and a large one that ends or is cancelled.

#include <doctest/doctest.h>

#include "engine/workbench/services/photographer.h"
#include "tests/gpu/workbench/services/desk_with_scan.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

struct PhotographerAlone : DeskWithScan {
    Photographer photographer{desk, {.pixels = [] { return glm::uvec2(48, 40); }}};
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
    document().annotator.begin_stroke(document().stroke());
    photographer.advance();
    CHECK_FALSE(photographer.has_large());
    CHECK(says("cancelled by painting"));
    document().annotator.end_stroke();
}

// Background work that is not a job of the workers: loading the volume again, and large pictures.

#include <chrono>
#include <thread>

#include <doctest/doctest.h>

#include "tests/support/gpu.h"
#include "tests/support/volume_files.h"
#include "tests/support/workbench_state.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

constexpr const char *PAGED = R"({"render":{"paging":"always"}})", *RESIDENT = R"({"render":{"paging":"never"}})";

struct PagedDesk {
    TemporaryFolder folder;
    Renderer renderer{{.device = {}, .budget = {.device_bytes = uint64_t{64} << 20, .host_bytes = 0}}};
    Workbench bench{renderer, {.has_servo = false}};

    PagedDesk()
    {
        folder.write("scan.json", R"({"shvr_session": 1,
            "volume": {"procedural": "tubes", "size": [160, 160, 160], "seed": 4}, "render": {"paging": "always"}})");
        bench.set_pixels({48, 40});
        bench.open(folder.path / "scan.json", {});
        settle(bench);
    }
    bool is_paged() const { return renderer.volume().counts().has_value(); }
    const Jobs::State* job(const std::string& what)
    {
        jobs_ = bench.model().jobs;
        for (const Jobs::State& state : jobs_)
            if (state.what.starts_with(what)) return &state;
        return nullptr;
    }
    void stroke(uint8_t group)
    {
        bench.perform(
            PaintOp{.brush = Brush::fill, .group = group, .threshold = 0, .radius_voxels = 5, .path = {{80, 80, 80}}});
    }

private:
    std::vector<Jobs::State> jobs_;
};

}  // namespace

TEST_CASE("settings that load the volume once more do so beside the work, and what is shown stays in use")
{
    PagedDesk desk;
    CHECK(desk.is_paged());
    desk.bench.perform(Set{RESIDENT});
    CHECK(desk.is_paged());
    CHECK(desk.bench.shows_jobs());
    REQUIRE(desk.job("loading scan.json once more"));
    bool was_painted = false;
    for (int turn = 0; turn < 60'000 && desk.job("loading scan.json once more"); ++turn) {
        desk.bench.advance();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        if (std::exchange(was_painted, true)) continue;
        CHECK(desk.bench.is_open());
        desk.stroke(3);
    }
    CHECK_FALSE(desk.is_paged());
    settle(desk.bench);
    CHECK(desk.bench.model().voxels_by_group[3] > 0);
    CHECK(desk.bench.model().view_is_complete);
    // Paint added meanwhile is on the device: undo and the picture agree with the mask.
    desk.bench.perform(UndoOp{1});
    settle(desk.bench);
    CHECK(desk.bench.model().voxels_by_group[3] == 0);
}

TEST_CASE("loading once more can be cancelled, and then the setting is as it was")
{
    PagedDesk desk;
    desk.bench.perform(Set{RESIDENT});
    desk.bench.advance();
    const Jobs::State* const job = desk.job("loading scan.json once more");
    REQUIRE(job);
    desk.bench.perform(CancelJob{job->number});
    settle(desk.bench);
    CHECK(desk.is_paged());
    CHECK(desk.bench.model().session.render.paging == Paging::always);
}

TEST_CASE("where the device has no room for both, the document comes back with its work")
{
    PagedDesk desk;
    desk.stroke(3);
    const int64_t painted = desk.bench.model().voxels_by_group[3];
    for (const char* const settings : {RESIDENT, PAGED}) {  // bricks take what room there is
        desk.bench.perform(Set{settings});
        settle(desk.bench);
        CHECK(desk.is_paged() == (settings == PAGED));
        CHECK(desk.bench.model().voxels_by_group[3] == painted);
    }
    CHECK(desk.bench.model().undoable == 1);
    // A volume too large for this setting is refused at once, with nothing changed.
    TemporaryFolder folder;
    folder.write("large.json", R"({"shvr_session": 1,
        "volume": {"procedural": "tubes", "size": [340, 340, 340], "seed": 4}, "render": {"paging": "always"}})");
    desk.bench.open(folder.path / "large.json", {});
    CHECK_THROWS_AS(desk.bench.perform(Set{RESIDENT}), Error);
    CHECK(desk.bench.model().session.render.paging == Paging::always);
    CHECK_FALSE(desk.bench.shows_jobs());
}

TEST_CASE("paint that has no room beside two scenes is shown once the earlier one is gone, without a third")
{
    PagedDesk desk;
    desk.bench.perform(Set{RESIDENT});
    desk.bench.advance();
    REQUIRE(desk.job("loading scan.json once more"));
    gpu::Memory& memory = desk.renderer.memory();
    memory.free_idle();
    constexpr uint64_t LEFT = uint64_t{256} << 10;  // for fewer bricks than the stroke paints
    REQUIRE(memory.device_bytes_left() > LEFT);
    const gpu::Storage other = memory.create("another", buffer_desc(memory.device_bytes_left() - LEFT));
    desk.stroke(3);
    const uint64_t before = desk.renderer.scene().number();
    for (int turn = 0; turn < 60'000 && desk.bench.has_work(); ++turn) {
        desk.bench.advance();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        CHECK(desk.bench.is_open());
    }
    CHECK(desk.renderer.scene().number() == before + 1);
    CHECK_FALSE(desk.is_paged());
    CHECK(desk.bench.model().session.render.paging == Paging::never);
    CHECK(desk.bench.model().voxels_by_group[3] > 0);
    CHECK_FALSE(desk.renderer.scene().is_behind());
    CHECK(desk.bench.model().view_is_complete);
}

TEST_CASE("a large screenshot is among the jobs, and is cancelled as one")
{
    PagedDesk desk;
    desk.bench.perform(Set{R"({"interaction":{"screenshot_scale":8}})"});
    settle(desk.bench);
    desk.bench.perform(Screenshot{.is_large = true});
    const Jobs::State* const job = desk.job("drawing ");
    REQUIRE(job);
    CHECK(job->fraction >= 0.0);
    desk.bench.perform(CancelJob{job->number});
    CHECK(desk.bench.messages().last() == "Cancelled: the large screenshot");
    CHECK_FALSE(desk.bench.takes_large_screenshot());
    for (const std::filesystem::directory_entry& entry : std::filesystem::directory_iterator(desk.folder.path))
        CHECK(entry.path().extension() != ".png");
}

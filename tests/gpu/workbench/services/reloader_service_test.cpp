// The reloader alone: the scene is replaced in slices, or the settings return to those of the scene that is shown.

#include <doctest/doctest.h>

#include <atomic>
#include <thread>

#include "engine/workbench/services/reloader.h"
#include "tests/gpu/workbench/services/desk_with_scan.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

/// A volume without coarser levels that counts the reads of the thread that made it.
class Counting final : public VolumeSource {
public:
    explicit Counting(std::shared_ptr<const VolumeSource> of) : VolumeSource(of->info()), of_(std::move(of)) {}
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        reads_of_main += std::this_thread::get_id() == main_;
        if (is_broken) fail("scan.raw: the disk is gone");
        of_->read(box, voxels);
    }
    mutable std::atomic<int> reads_of_main = 0;
    std::atomic<bool> is_broken = false;

private:
    std::shared_ptr<const VolumeSource> of_;
    std::thread::id main_ = std::this_thread::get_id();
};

struct ReloaderAlone : DeskWithScan {
    bool is_opening = false, is_drawing = false;
    Reloader reloader{desk,
                      {.is_opening = [this] { return is_opening; },
                       .opening_name = [] { return std::string_view("other.json"); },
                       .load_alone = notes("load_alone"),
                       .is_drawing_picture = [this] { return is_drawing; },
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
    /// Changes the paging as the editor of settings does, for a volume whose reads are counted.
    std::shared_ptr<Counting> want_paged()
    {
        const auto source = std::make_shared<Counting>(document().source);
        document().source = document().scene_source = source;
        const RenderSettings before = document().session.render;
        document().session.render.paging = Paging::always;
        reloader.want(before);
        return source;
    }
    void step()
    {
        for (const Jobs::Finished& job : desk.jobs.finish()) CHECK((job.was_cancelled || reloader.end_reading(job)));
        reloader.advance();
    }
    void await_end()
    {
        until([&] { step(); }, [&] { return !reloader.is_wanted(); });
    }
};

}  // namespace

TEST_CASE_FIXTURE(ReloaderAlone, "reloader: the shown scene stays until the next one is loaded")
{
    const Scene* const before = &renderer().scene();
    want_filtered();
    CHECK(reloader.is_wanted());
    await_end();
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

TEST_CASE_FIXTURE(ReloaderAlone, "reloader: coarser levels for paging are made on the worker")
{
    const auto source = want_paged();
    await_end();
    CHECK(take_calls() == "drop_screenshot load_alone");
    CHECK(source->reads_of_main == 0);
    CHECK(document().source == source);
    CHECK(document().scene_source->levels() > 1);

    const RenderSettings before = document().session.render;
    document().session.render.paging = Paging::never;
    reloader.want(before);
    await_end();
    CHECK(says("Reloaded"));
    CHECK(document().scene_source == source);
}

TEST_CASE_FIXTURE(ReloaderAlone,
                  "reloader: if coarser levels cannot be made, the settings are those of the shown scene")
{
    const Scene* const shown = &renderer().scene();
    want_paged()->is_broken = true;
    await_end();
    CHECK(says("the disk is gone; the volume stays as it was loaded"));
    CHECK(document().session.render.paging == Paging::automatic);
    CHECK(&renderer().scene() == shown);
}

TEST_CASE_FIXTURE(ReloaderAlone, "reloader: cancelled while coarser levels are made")
{
    const auto source = want_paged();
    step();
    std::vector<Jobs::State> states;
    reloader.add_loading(states);
    CHECK(states.empty());  // the job is in the list of jobs
    CHECK(reloader.cancel());
    until([&] { step(); }, [&] { return desk.jobs.is_idle(); });
    CHECK(document().session.render.paging == Paging::automatic);
    CHECK(document().scene_source == source);
}

TEST_CASE_FIXTURE(ReloaderAlone, "reloader: nothing is reloaded while another file is opened")
{
    is_opening = true;
    CHECK(contains(error_of([&] { want_filtered(); }), "other.json is being opened"));
    CHECK_FALSE(reloader.is_wanted());
    is_opening = false;
    is_drawing = true;
    CHECK(contains(error_of([&] { want_filtered(); }), "movie is being drawn"));
    CHECK_FALSE(reloader.is_wanted());
}

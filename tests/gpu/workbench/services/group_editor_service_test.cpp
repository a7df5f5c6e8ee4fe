// The editor of groups alone: an operation is one step, unless groups change while it is computed or it is cancelled.

#include <atomic>
#include <thread>

#include <doctest/doctest.h>

#include "engine/workbench/lists/group_list.h"
#include "engine/workbench/services/operations/group_editor.h"
#include "tests/gpu/workbench/services/desk_with_scan.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

struct GroupsAlone : DeskWithScan {
    GroupEditor groups{desk,
                       {.record_settings = notes("record_settings"),
                        .show_changes = notes("show_changes"),
                        .advance_jobs = [this] { finish_jobs(); }}};
    void finish_jobs()
    {
        for (const Jobs::Finished& job : desk.jobs.finish())
            if (!groups.ends_preview(job) && !job.failure.empty()) desk.say(job.failure, Weight::error);
    }
    void await_end()
    {
        until([&] { finish_jobs(); }, [&] { return desk.jobs.is_idle(); });
    }
    int64_t voxels(size_t group) { return document().annotator.document().mask.voxels_by_group()[group]; }
    size_t steps() { return document().annotator.history().undoable(); }
};

}  // namespace

TEST_CASE_FIXTURE(GroupsAlone, "groups: an operation is computed as a job, and becomes one step that undo takes back")
{
    paint();
    const int64_t painted = voxels(1);
    groups.act(CombineOp{.group = 7, .with = 1, .how = CombineOp::How::add});
    CHECK(steps() == 1);
    CHECK(take_calls() == "record_settings");
    await_end();
    CHECK(steps() == 2);
    CHECK(voxels(7) == painted);
    CHECK(take_calls() == "record_settings show_changes");
    CHECK(says("Combine groups: " + std::to_string(painted) + " voxels of group 1 moved to group 7"));
    CHECK(document().annotator.history().label_of(1) == "combine groups, group 7");
    document().annotator.undo();
    CHECK(voxels(1) == painted);
}

TEST_CASE_FIXTURE(GroupsAlone,
                  "groups: what was painted while an operation was computed is kept, and its result dropped")
{
    paint();
    groups.act(GrowOp{.group = 1, .distance = 2.0});
    document().annotator.undo();
    document().annotator.redo();
    const int64_t painted = voxels(1);
    await_end();
    CHECK(says("Grow: the annotation was changed while this was computed, so nothing was done; repeat it"));
    CHECK(voxels(1) == painted);
    CHECK(steps() == 1);
    groups.act(GrowOp{.group = 1, .distance = 2.0});
    const int64_t grown = groups.finish({}).voxels;
    CHECK(grown > 0);
    CHECK(voxels(1) == painted + grown);
}

TEST_CASE_FIXTURE(GroupsAlone,
                  "groups: an operation that changes nothing needs attention only where a lock kept it from it")
{
    const CombineOp add{.group = 7, .with = 1, .how = CombineOp::How::add};
    groups.act(add);
    await_end();
    CHECK(says("Combine groups: nothing changed"));
    CHECK(desk.messages.all().back().weight == Weight::done);
    paint();
    document().session.groups[1].locked = true;
    groups.act(add);
    await_end();
    CHECK(says("group 1 is locked"));
    CHECK(desk.messages.all().back().weight == Weight::warning);
}

TEST_CASE_FIXTURE(GroupsAlone, "groups: an operation that is cancelled or fails changes nothing, and says so")
{
    paint();
    groups.act(ShrinkOp{.group = 1, .distance = 1.0});
    const auto stop = [](double) { throw Stopped("stopped"); };
    CHECK_THROWS_AS(static_cast<void>(groups.finish(stop)), Stopped);
    CHECK(desk.jobs.is_idle());
    CHECK(steps() == 1);
    groups.act(GrowOp{.group = 1, .distance = 1e9});
    CHECK_THROWS_WITH_AS(static_cast<void>(groups.finish({})),
                         "the distance is 1e+09, 1e+09 voxels along x; expected at most 512 voxels", Error);
    CHECK(steps() == 1);
}

TEST_CASE_FIXTURE(GroupsAlone,
                  "groups: an operation is refused while another is computed, but not once it is cancelled")
{
    paint();
    const int64_t painted = voxels(1);
    // A job before it keeps it from beginning, so it is certain to be there.
    std::atomic<bool> goes_on = false;
    const auto hold = [&](ProgressReporter&) -> Jobs::Completion {
        while (!goes_on) std::this_thread::yield();
        return {};
    };
    desk.jobs.start("holds the worker", hold);
    groups.act(GrowOp{.group = 1, .distance = 2.0});
    CHECK_THROWS_WITH_AS(
        groups.act(ShrinkOp{.group = 1, .distance = 1.0}),
        "Shrink: \"grow, group 1\" is still being computed; expected it to have ended: wait for it, or "
        "cancel it in the list of jobs",
        Error);
    goes_on = true;
    await_end();
    CHECK(voxels(1) > painted);
    CHECK(steps() == 2);
    goes_on = false;
    desk.jobs.start("holds the worker", hold);
    groups.act(GrowOp{.group = 1, .distance = 2.0});
    desk.jobs.cancel_all();
    groups.act(ShrinkOp{.group = 1, .distance = 1.0});
    goes_on = true;
    await_end();
    CHECK(steps() == 3);
    CHECK(document().annotator.history().label_of(2) == "shrink, group 1");
}

TEST_CASE_FIXTURE(GroupsAlone,
                  "groups: a preview counts and shows what the operation then changes, and changes nothing")
{
    paint();
    const int64_t painted = voxels(1);
    const PreviewOperation grow{R"({"op":"grow","group":1,"distance":2})"};
    groups.act(grow);
    CHECK(groups.model().previewed == grow.operation);
    CHECK(groups.model().is_previewing);
    await_end();
    CHECK(groups.model().is_preview_current);
    CHECK(voxels(1) == painted);
    CHECK(steps() == 1);
    REQUIRE(document().operation_preview);
    const PaintPreview preview = *document().operation_preview;
    CHECK(document().probe_look().preview == document().operation_preview);
    groups.act(GrowOp{.group = 1, .distance = 2.0});
    CHECK_FALSE(document().operation_preview);
    CHECK(preview.voxels == groups.finish({}).voxels);
    CHECK(preview.kind == PaintPreview::Kind::group);

    groups.act(grow);
    await_end();
    const std::string words = groups.model().preview_words;
    CHECK(words ==
          "Grow: " + std::to_string(document().operation_preview->voxels) + " voxels would be painted in group 1");
    document().annotator.undo();
    CHECK_FALSE(groups.model().is_preview_current);  // it is about voxels that are no longer there
    groups.act(PreviewOperation{R"({"op":"shrink","group":1,"distance":1})"});
    await_end();
    CHECK(document().operation_preview->kind == PaintPreview::Kind::erase);
    groups.act(PreviewOperation{});
    CHECK_FALSE(document().operation_preview);
    CHECK(groups.model().previewed.empty());
}

TEST_CASE_FIXTURE(GroupsAlone,
                  "groups: what is applied is known until the annotation or what is previewed becomes another")
{
    paint();
    const std::string line = line_of(Action(GrowOp{.group = 1, .distance = 2.0}));
    CHECK(groups.model().applied.empty());
    groups.act(GrowOp{.group = 1, .distance = 2.0});
    CHECK(groups.model().applied == line);
    CHECK(groups.model().is_applying);
    await_end();
    CHECK(groups.model().applied == line);
    CHECK_FALSE(groups.model().is_applying);
    document().annotator.undo();
    CHECK(groups.model().applied.empty());
    groups.act(GrowOp{.group = 1, .distance = 2.0});
    await_end();
    document().session.groups[2].locked = true;
    CHECK(groups.model().applied.empty());
    document().session.groups[2].locked = false;
    CHECK(groups.model().applied == line);
    groups.act(PreviewOperation{R"({"op":"shrink","group":1,"distance":1})"});
    await_end();
    CHECK(groups.model().applied.empty());
    groups.act(GrowOp{.group = 1, .distance = 1e9});  // fails
    await_end();
    CHECK(groups.model().applied.empty());
    CHECK_FALSE(groups.model().is_applying);
}

TEST_CASE_FIXTURE(GroupsAlone, "groups: a trace from a mask is known as applied until the trace becomes another")
{
    paint();
    const std::string line = line_of(Action(TraceFromMaskOp{.group = 1}));
    groups.act(PreviewOperation{line});
    await_end();
    CHECK(groups.model().is_preview_current);
    CHECK(groups.model().preview_words.starts_with("Trace from mask (preview): "));
    groups.act(TraceFromMaskOp{.group = 1});
    await_end();
    CHECK(groups.model().applied == line);
    document().annotator.undo();
    CHECK(groups.model().applied.empty());
}

TEST_CASE_FIXTURE(GroupsAlone, "groups: a preview that is about other locks is not current, and one can be cancelled")
{
    paint();
    groups.act(PreviewOperation{R"({"op":"grow","group":1,"distance":2})"});
    await_end();
    CHECK(groups.model().is_preview_current);
    document().session.groups[1].locked = true;
    CHECK_FALSE(groups.model().is_preview_current);
    groups.act(PreviewOperation{R"({"op":"grow","group":1,"distance":3})"});
    desk.jobs.cancel_all();
    await_end();
    CHECK_FALSE(groups.model().is_previewing);
    CHECK(groups.model().has_preview_failed);
    CHECK(groups.model().preview_words == "the preview was cancelled; any change starts another");
}

TEST_CASE_FIXTURE(GroupsAlone,
                  "groups: a preview that fails says why where it would be shown, and a replaced one is gone")
{
    paint();
    groups.act(PreviewOperation{R"({"op":"grow","group":1,"distance":600})"});
    await_end();
    CHECK(groups.model().has_preview_failed);
    CHECK(groups.model().preview_words == "the distance is 600, 600 voxels along x; expected at most 512 voxels");
    CHECK_FALSE(document().operation_preview);
    CHECK_FALSE(says("the distance is 600, 600 voxels along x; expected at most 512 voxels"));
    CHECK_THROWS_WITH_AS(groups.act(PreviewOperation{R"({"op":"undo"})"}),
                         R"(preview_operation: "{"op":"undo"}" is no operation on groups; expected one, such as grow)",
                         Error);
    groups.act(PreviewOperation{R"({"op":"grow","group":1,"distance":3})"});
    groups.act(PreviewOperation{R"({"op":"shrink","group":1,"distance":1})"});
    await_end();
    CHECK(groups.model().preview_words.starts_with("Shrink: "));
    CHECK(document().operation_preview->kind == PaintPreview::Kind::erase);
}

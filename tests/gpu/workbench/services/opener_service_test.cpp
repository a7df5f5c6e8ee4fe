// The opener alone: what it asks for before it replaces the document, and what it leaves where it fails.

#include <doctest/doctest.h>

#include "engine/workbench/services/opener.h"
#include "engine/workbench/services/saver.h"
#include "tests/gpu/workbench/services/desk_with_scan.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

struct OpenerAlone : DeskWithScan {
    Leave may_leave = Leave::now;
    std::vector<std::filesystem::path> taken;
    std::vector<std::string> asked;
    Opener opener{desk,
                  keeper,
                  {.advance_jobs = [this] { end_jobs(); },
                   .leave =
                       [this](std::string& why) {
                           if (may_leave == Leave::refused) why = "the disk is full";
                           return may_leave;
                       },
                   .is_saving = [] { return false; },
                   .cancel_reload =
                       [this] {
                           calls.emplace_back("cancel_reload");
                           return false;
                       },
                   .drop_screenshot = notes("drop_screenshot"),
                   .look_again = notes("look_again"),
                   .look_from = notes("look_from"),
                   .load_annotation = [this](const LoadAnnotation& file) { taken.push_back(file.path); },
                   .ask_what_it_is = [this](const UnclearFile& file) { asked.push_back(file.why); },
                   .record_settings = notes("record_settings"),
                   .begin_document = notes("begin_document")}};
    std::filesystem::path other = folder.path / "other.json";

    OpenerAlone() { write_session(other); }
    void end_jobs()
    {
        for (const Jobs::Finished& job : desk.jobs.finish()) CHECK((job.was_cancelled || opener.end_reading(job)));
    }
    void step()
    {
        end_jobs();
        opener.advance();
    }
    void await_end()
    {
        until([this] { step(); }, [this] { return !opener.is_opening(); });
    }
};

}  // namespace

TEST_CASE_FIXTURE(OpenerAlone, "opener: the next document replaces the open one when that may be left")
{
    const ui::Document* const before = desk.document.get();
    may_leave = Leave::later;
    opener.begin_open(other, {}, {folder.path / "a.mask"});
    CHECK(opener.opening_name() == "other.json");
    until([this] { step(); }, [this] { return desk.jobs.is_idle(); });
    for (int turn = 0; turn < 5; ++turn) step();
    CHECK(desk.document.get() == before);
    CHECK(take_calls() == "cancel_reload");
    may_leave = Leave::now;
    await_end();
    CHECK(document().session_path == other);
    CHECK(take_calls() == "drop_screenshot look_again begin_document");
    CHECK(taken == std::vector{folder.path / "a.mask"});
    CHECK(desk.openings == 2);
}

TEST_CASE_FIXTURE(OpenerAlone, "opener: work that cannot be saved stays open, and so does a scan before a broken file")
{
    may_leave = Leave::refused;
    opener.begin_open(other, {});
    await_end();
    CHECK(document().session_path == session_path);
    CHECK(contains(opener.model().open_failure, "the open work cannot be saved: the disk is full"));
    opener.begin_open(folder.path / "missing.json", {});
    await_end();
    CHECK(document().session_path == session_path);
    CHECK(*opener.model().failed_path == folder.path / "missing.json");
    CHECK(desk.openings == 1);
}

TEST_CASE_FIXTURE(OpenerAlone, "opener: only its own job ends or cancels an opening")
{
    opener.begin_open(other, {});
    std::vector<Jobs::State> states;
    opener.add_read(states);
    REQUIRE(states.size() == 1);
    CHECK_FALSE(opener.cancel(states[0].number + 1));
    CHECK_FALSE(opener.end_reading({.number = states[0].number + 1}));
    CHECK(opener.is_opening());
    CHECK(opener.cancel(states[0].number));
    CHECK_FALSE(opener.is_opening());
    CHECK(says("Cancelled: opening other.json"));
    CHECK_FALSE(opener.cancel(states[0].number));
    until([this] { static_cast<void>(desk.jobs.finish()); }, [this] { return desk.jobs.is_idle(); });
    CHECK(document().session_path == session_path);
}

TEST_CASE_FIXTURE(OpenerAlone, "opener: the document is put away and comes back with its work")
{
    document().annotator.paint(document().dab());
    const size_t steps = document().annotator.history().undoable();
    opener.put_away();
    CHECK(desk.document == nullptr);
    opener.bring_back();
    CHECK(opener.is_opening());
    await_end();
    REQUIRE(desk.document);
    CHECK(document().annotator.history().undoable() == steps);
    CHECK(says("is shown again"));
}

TEST_CASE_FIXTURE(OpenerAlone, "opener: a lost device is no reason to wait for a volume on another machine")
{
    document().annotator.paint(document().dab());
    const size_t steps = document().annotator.history().undoable();
    document().session.volume_path = "http://127.0.0.1:1/x.zarr";
    opener.begin_open(other, {});
    opener.restart_device([this] { renderer().restart(); });
    CHECK(desk.document == nullptr);
    CHECK(opener.is_opening());
    CHECK(opener.opening_name() == "scan.json");  // and not the other one, which would leave this one unsaved
    await_end();
    REQUIRE(desk.document);
    CHECK(document().annotator.history().undoable() == steps);
    CHECK(document().session_path == session_path);
}

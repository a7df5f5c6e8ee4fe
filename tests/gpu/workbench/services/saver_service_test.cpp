// The saver alone: what a save waits for, what it writes, and when the document may be left.

#include <doctest/doctest.h>

#include "engine/workbench/services/saver.h"
#include "tests/gpu/workbench/services/desk_with_scan.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

struct SaverAlone : DeskWithScan {
    bool is_stuck = false, is_writing = false, is_discarded = false;
    std::filesystem::path opened;
    Saver saver{desk,
                keeper,
                {.begin_open = [this](const std::filesystem::path& path) { opened = path; },
                 .extend_stroke = notes("extend_stroke"),
                 .finish_stroke = [] { return std::string(); },
                 .is_stuck = [this] { return is_stuck; },
                 .note_progress = [] {},
                 .is_writing = [this] { return is_writing; },
                 .record_settings = notes("record_settings"),
                 .discard = notes("discard"),
                 .is_discarded = [this] { return is_discarded; },
                 .advance_jobs =
                     [this] {
                         for (const Jobs::Finished& job : desk.savers.finish()) saver.end(job);
                     },
                 .look_again = notes("look_again")}};
    std::filesystem::path mask = folder.path / "scan.mask";

    Leave leave()
    {
        std::string why;
        const Leave answer = saver.leave(why);
        CHECK((answer == Leave::refused) == !why.empty());
        return answer;
    }
};

}  // namespace

TEST_CASE_FIXTURE(SaverAlone, "saver: a save takes in the stroke and the settings, and writes the files")
{
    document().annotator.paint(document().dab());
    CHECK_FALSE(saver.model().is_saved);
    saver.act(SaveOp{});
    CHECK(take_calls() == "extend_stroke record_settings");
    CHECK(saver.is_saving());
    CHECK(contains(error_of([&] { saver.act(SaveAs{folder.path / "new.json"}); }), "is being saved"));
    saver.finish_save();
    CHECK_FALSE(saver.is_saving());
    CHECK(saver.model().is_saved);
    CHECK(std::filesystem::exists(mask));
    saver.act(SaveAs{folder.path / "new.json"});
    saver.finish_save();
    CHECK(document().session_path == folder.path / "new.json");
    CHECK(contains(take_calls(), "look_again"));
    CHECK_FALSE(error_of([&] { saver.act(SaveAs{session_path}); }).empty());
}

TEST_CASE_FIXTURE(SaverAlone, "saver: a save waits for the stroke, and gives it up only when that is stuck")
{
    document().annotator.begin_stroke(document().stroke());
    document().annotator.extend_stroke({20, 18, 16});
    saver.act(SaveOp{});
    CHECK(document().annotator.stroke_is_running());
    CHECK_FALSE(document().annotator.stroke_is_open());
    saver.advance();
    CHECK_FALSE(std::filesystem::exists(mask));
    CHECK(document().annotator.stroke_is_running());
    is_stuck = true;
    saver.advance();
    CHECK_FALSE(document().annotator.stroke_is_running());
    saver.finish_save();
    CHECK(says("the rest of the stroke was not painted"));
}

TEST_CASE_FIXTURE(SaverAlone, "saver: the document is left after its save, and after files that are being written")
{
    document().annotator.paint(document().dab());
    is_writing = true;
    const size_t before = desk.messages.all().size();
    CHECK(leave() == Leave::later);
    CHECK(leave() == Leave::later);
    CHECK(desk.messages.all().size() == before + 1);
    CHECK_FALSE(saver.is_saving());
    is_writing = false;
    CHECK(leave() == Leave::later);
    CHECK(saver.is_saving());
    saver.finish_save();
    CHECK(leave() == Leave::now);
    CHECK(std::filesystem::exists(mask));
}

TEST_CASE_FIXTURE(SaverAlone, "saver: closing that waits for a file is shown, and can be taken back")
{
    std::string why;
    CHECK_FALSE(saver.model().waits_to_close);
    is_writing = true;
    CHECK(saver.close(why) == Leave::later);
    CHECK(saver.model().waits_to_close);
    saver.act(StayOpen{});
    CHECK_FALSE(saver.model().waits_to_close);
    CHECK(saver.take_stay_open());
    CHECK_FALSE(saver.take_stay_open());
    CHECK(says("stays open"));
    saver.stay_open();  // nothing waits
    CHECK_FALSE(saver.take_stay_open());
    CHECK(saver.close(why) == Leave::later);
    is_writing = false;
    CHECK_FALSE(saver.model().waits_to_close);
    CHECK(saver.close(why) == Leave::now);
}

TEST_CASE_FIXTURE(SaverAlone, "saver: discarded work is left unsaved; quitting is asked for once")
{
    document().annotator.paint(document().dab());
    saver.act(Quit{.saves = false});
    CHECK(take_calls() == "discard");
    is_discarded = true;
    CHECK(leave() == Leave::now);
    CHECK_FALSE(std::filesystem::exists(mask));
    CHECK(saver.take_quit());
    CHECK_FALSE(saver.take_quit());
}

TEST_CASE_FIXTURE(SaverAlone, "saver: another spacing is saved, then the session is opened again")
{
    saver.act(CorrectSpacing{.spacing = glm::dvec3(2.0), .unit = {}});
    CHECK(opened.empty());
    saver.finish_save();
    CHECK(opened == session_path);
    CHECK(contains(bytes_of_file(session_path), "\"spacing\""));
}

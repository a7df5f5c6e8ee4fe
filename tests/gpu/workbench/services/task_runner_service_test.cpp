// The runner of tasks alone: which service an ended or cancelled job belongs to, and what is being written.

#include <doctest/doctest.h>

#include "engine/workbench/services/task_runner.h"
#include "tests/gpu/workbench/services/desk_with_scan.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

struct TasksAlone : DeskWithScan {
    bool is_of_opening = false, is_of_another = false;
    std::filesystem::path opened;
    TaskRunner tasks{desk,
                     keeper,
                     {.end_save = notes("end_save"),
                      .end_reading = [this](const Jobs::Finished&) { return is_of_opening; },
                      .cancel = [this](Jobs::Number) { return is_of_another; },
                      .add_loading = [](std::vector<Jobs::State>& states) { states.push_back({.what = "loading"}); },
                      .add_reading = [](std::vector<Jobs::State>& states) { states.push_back({.what = "reading"}); },
                      .open = [this](const std::filesystem::path& path) { opened = path; },
                      .record_settings = notes("record_settings"),
                      .stay_open = notes("stay_open")}};
    void await_end()
    {
        until([&] { tasks.advance(); }, [&] { return desk.jobs.is_idle() && desk.savers.is_idle(); });
    }
    static Jobs::Completion broken(ProgressReporter&) { fail("the file is broken"); }
};

}  // namespace

TEST_CASE_FIXTURE(TasksAlone, "tasks: a job that fails is reported, unless it is the opener's; savers' go to the saver")
{
    desk.jobs.start("a job", broken);
    await_end();
    CHECK(says("the file is broken"));
    const size_t count = desk.messages.all().size();
    is_of_opening = true;
    desk.jobs.start("an opening", broken);
    await_end();
    CHECK(desk.messages.all().size() == count);
    CHECK(take_calls().empty());
    desk.savers.start("a save", broken);
    await_end();
    CHECK(desk.messages.all().size() == count);
    CHECK(take_calls() == "end_save");
}

TEST_CASE_FIXTURE(TasksAlone, "tasks: a number of another service cancels no job")
{
    std::atomic<bool> ends = false;
    const Jobs::Number number = desk.jobs.start("a job", [&](ProgressReporter& reporter) -> Jobs::Completion {
        while (!ends) {
            static_cast<void>(reporter.begin("waiting"));
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        return {};
    });
    CHECK(tasks.model().jobs.front().what == "loading");
    CHECK(tasks.model().jobs.back().what == "reading");
    CHECK(tasks.model().jobs.size() == 3);
    is_of_another = true;
    tasks.act(CancelJob{number});
    is_of_another = false;
    CHECK_FALSE(says("Cancelled"));
    tasks.act(CancelJob{number});
    await_end();
    CHECK(says("Cancelled: a job"));
    ends = true;
}

TEST_CASE_FIXTURE(TasksAlone, "tasks: an export has the settings so far, and is being written until it ends")
{
    document().annotator.paint(document().dab());
    tasks.act(ExportTask{.mask = folder.path / "out.mask"});
    CHECK(take_calls() == "record_settings");
    CHECK(tasks.is_writing());
    await_end();
    CHECK_FALSE(tasks.is_writing());
    CHECK(std::filesystem::exists(folder.path / "out.mask"));
    CHECK(says("Exported"));
}

TEST_CASE_FIXTURE(TasksAlone, "tasks: an export that fails keeps a window open that waits for it")
{
    document().annotator.paint(document().dab());
    std::filesystem::create_directory(folder.path / "out.mask");
    tasks.act(ExportTask{.mask = folder.path / "out.mask"});
    static_cast<void>(take_calls());
    await_end();
    CHECK(take_calls() == "stay_open");
    CHECK(desk.messages.all().back().weight == Weight::error);
}

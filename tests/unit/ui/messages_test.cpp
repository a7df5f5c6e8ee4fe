// Messages and actions in the words of the status bar and of a report; and the history as a list to jump in.

#include <doctest/doctest.h>

#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/bindings/keymap.h"
#include "engine/workbench/lists/bug_report.h"
#include "engine/workbench/lists/history_list.h"
#include "engine/workbench/lists/recent_actions.h"
#include "engine/workbench/models/preferences.h"

using namespace shvr;
using namespace shvr::ui;

namespace {

/// Everything that a model refers to.
struct Place {
    Session session;
    VolumeInfo volume;
    VolumeStatistics statistics;
    Camera camera;
    std::vector<Screen::Part> panes;
    std::vector<TransferPreset> presets;
    TraceGraph trace;
    std::filesystem::path path{"/scans/leaf/session.json"};
    MessageLog messages;
    Keymap keymap;
    Preferences preferences;
    RecentActions recent;
    History history;
    Model model{{.is_open = true,
                 .session = session,
                 .volume = volume,
                 .statistics = statistics,
                 .camera = camera,
                 .session_path = path,
                 .messages = messages},
                {.panes = panes},
                {},
                {},
                {},
                {},
                {},
                {.trace = trace},
                {.history = &history},
                {},
                {},
                {},
                {},
                {.keymap = keymap, .preferences = preferences},
                {.presets = presets},
                {.gpu_name = "a device"},
                {.recent = &recent, .version = "1.2.3"}};
};

Command dab(const std::string& label, int64_t brick, std::vector<MaskRun> runs)
{
    Command command{label, {}};
    command.changes.emplace_back(MaskBrickChange{brick, std::move(runs)});
    return command;
}

std::string text_of(const std::optional<Action>& action)
{
    return action ? ui::text_of(*action) : "(nothing)";
}

}  // namespace

TEST_CASE("Where there is no room, paths are cut down to their last names")
{
    CHECK(without_folders("Saved /scans/leaf/mask.smsk, /scans/leaf/trace.json and /scans/leaf/session.json") ==
          "Saved .../mask.smsk, .../trace.json and .../session.json");
    CHECK(without_folders("Opened /scans/a leaf/stem 2.nrrd") == "Opened .../stem 2.nrrd");
    CHECK(without_folders("/scans/leaf/: there is no volume; try /scans") ==
          ".../leaf/: there is no volume; try /scans");
    CHECK(without_folders("3 / 4 of a um/px") == "3 / 4 of a um/px");
    CHECK(without_folders("/") == "/");
    CHECK(without_folders("").empty());
}

TEST_CASE("errors and warnings count as unread until the messages are looked at")
{
    MessageLog log;
    CHECK(unread_in_words(log).empty());
    log.add(1.0, Weight::done, "Opened");
    CHECK(unread_in_words(log).empty());
    log.add(2.0, Weight::error, "it failed");
    log.add(3.0, Weight::done, "Undone");
    CHECK(unread_in_words(log) == "1 error");
    log.add(4.0, Weight::warning, "careful");
    log.add(5.0, Weight::warning, "careful again");
    CHECK(unread_in_words(log) == "1 error, 2 warnings");
    for (size_t i = 0; i < MessageLog::MAX_MESSAGES; ++i) log.add(6.0, Weight::done, "x");
    CHECK(unread_in_words(log) == "1 error, 2 warnings");  // though they are forgotten by now
    log.note_read();
    CHECK(unread_in_words(log).empty());
    log.add(7.0, Weight::error, "once more");
    CHECK(unread_in_words(log) == "1 error");
}

TEST_CASE("a message follows what it tells, but never takes the place of another")
{
    MessageLog log;
    const uint64_t number = log.amend(0, 1.0, "20 %");
    CHECK(number == 1);
    CHECK(log.amend(number, 5.0, "40 %") == number);
    REQUIRE(log.all().size() == 1);
    CHECK(log.last() == "40 %");
    CHECK(log.all().back().time_s == 5.0);
    log.add(6.0, Weight::warning, "careful");
    CHECK(log.amend(number, 7.0, "60 %") == 3);
    REQUIRE(log.all().size() == 3);
    CHECK(log.all()[0].text == "40 %");
    CHECK(log.all()[1].text == "careful");
    CHECK(log.all()[1].weight == Weight::warning);
    CHECK(log.all()[2].weight == Weight::done);
    CHECK(log.amend(0, 8.0, "of something else") == 4);
    CHECK(log.count() == 4);
}

TEST_CASE("the last 50 actions are remembered, those that follow the mouse once, and refused ones as such")
{
    RecentActions recent;
    CHECK(recent.lines().empty());
    const auto act = [&](const Action& action, bool is_done = true) {
        recent.begin(action);
        if (is_done) recent.note_done();
    };
    act(Orbit{1, 0});
    act(Orbit{2, 0});
    act(Orbit{3, 0});
    act(UndoOp{2}, false);
    act(UndoOp{1});
    act(UndoOp{1});
    const std::vector<std::string> lines = recent.lines();
    REQUIRE(lines.size() == 4);
    CHECK(lines[0] == line_of(Action(Orbit{3, 0})) + " # the last of 3");
    CHECK(lines[1] == R"({"op":"undo","count":2} # refused)");
    CHECK(lines[2] == line_of(Action(UndoOp{1})));
    for (int i = 0; i < 100; ++i) act(RedoOp{i + 1});
    REQUIRE(recent.lines().size() == RecentActions::MAX_ENTRIES);
    CHECK(recent.lines().front() == line_of(Action(RedoOp{51})));
    CHECK(recent.lines().back() == line_of(Action(RedoOp{100})));
}

TEST_CASE("a report names version, device and session, and quotes the last actions and messages")
{
    Place place;
    place.volume.size = {40, 36, 32};
    place.recent.begin(SaveOp{});
    for (int i = 0; i < 60; ++i) place.messages.add(1.0, Weight::done, sentence("message ", i));
    place.messages.add(2.0, Weight::error, "the disk is full");
    const std::string report = bug_report(place.model);
    CAPTURE(report);
    CHECK(
        report.starts_with("- SHVR 1.2.3\n- device: a device\n- session: /scans/leaf/session.json, 40 x 36 x 32 "
                           "voxels\n\n"));
    CHECK(report.find("\n```\n{\"op\":\"save\"} # refused\n```\n") != std::string::npos);
    CHECK(report.find(" error: the disk is full\n```\n") != std::string::npos);
    CHECK(report.find(" message 11\n") != std::string::npos);
    CHECK(report.find(" message 10\n") == std::string::npos);  // the last 50, the error among them
    place.model.is_open = false;
    CHECK(bug_report(place.model).find("- session: (none)\n") != std::string::npos);
}

TEST_CASE("the history is a list whose rows are states, and a row is reached by one action")
{
    Place place;
    place.volume.size = Size3(64);
    shvr::Document document{Mask(place.volume.size)};
    CHECK(history_list(place.model).rows() == 1);
    for (int i = 0; i < 4; ++i)
        place.history.perform(document, dab(sentence("step ", i + 1), i, {{uint16_t(i), uint16_t(i), 0, 1}}));
    place.history.undo(document);
    place.model.undoable = 3;
    const HistoryList list = history_list(place.model);
    CHECK(list.rows() == 5);
    CHECK(list.present() == 3);
    CHECK(list.label_of(0) == "as it was opened first");
    CHECK(list.label_of(4) == "step 4");
    CHECK(text_of(go_to_row(list, 0)) == "undo count=3");
    CHECK(text_of(go_to_row(list, 2)) == "undo count=1");
    CHECK(text_of(go_to_row(list, 3)) == "(nothing)");
    CHECK(text_of(go_to_row(list, 4)) == "redo count=1");
    CHECK(text_of(go_to_row(list, 5)) == "(nothing)");
    // A setting that is not a step yet will be the newest step, and undone steps will be dropped.
    place.model.undoable = 4;
    const HistoryList ahead = history_list(place.model);
    CHECK(ahead.rows() == 5);
    CHECK(ahead.present() == 4);
    CHECK(ahead.label_of(4) == "settings");
    CHECK(text_of(go_to_row(ahead, 3)) == "undo count=1");
    CHECK_FALSE(place_of_row(ahead, place.model, 4));
}

TEST_CASE("a step is shown in the middle of what it changed")
{
    Place place;
    place.volume.size = {64, 64, 40};
    place.volume.spacing = {0.5, 0.5, 2.0};
    shvr::Document document{Mask(place.volume.size)};
    // In the second brick along x: voxels 34 to 37 of row 2, slice 1.
    place.history.perform(document, dab("one row", 1, {{1024 + 64 + 2, 1024 + 64 + 5, 0, 3}}));
    // Runs over the ends of rows and of slices take all between.
    place.history.perform(document, dab("two slices", 0, {{1000, 1100, 0, 3}}));
    Command node{"node", {}};
    node.changes.emplace_back(TraceChange(TraceNodeChange{0, {}, TraceNode{{5.0, 6.0, 8.0}, 1.0, 2}}));
    place.history.perform(document, std::move(node));
    // The last slice of bricks is cut at the border.
    place.history.perform(document, dab("border", 4, {{0, uint16_t(8 * 1024 - 1), 0, 3}}));
    place.model.undoable = 4;
    const HistoryList list = history_list(place.model);
    CHECK((place_of_row(list, place.model, 1)->middle() == glm::dvec3(36.0, 2.5, 1.5)));
    CHECK((place_of_row(list, place.model, 2)->middle() == glm::dvec3(16.0, 16.0, 1.0)));
    CHECK((place_of_row(list, place.model, 3)->middle() == glm::dvec3(10.0, 12.0, 4.0)));
    CHECK((place_of_row(list, place.model, 4)->middle() == glm::dvec3(16.0, 16.0, 36.0)));
    CHECK_FALSE(place_of_row(list, place.model, 0));
}

TEST_CASE("the first message of a weight beyond some is found, read or not, until it is forgotten")
{
    MessageLog log;
    log.add(0.0, Weight::error, "one");
    const uint64_t before = log.count();
    CHECK(log.first_after(before, Weight::error) == nullptr);
    for (const char* const text : {"two", "three"}) {
        log.add(1.0, Weight::done, "done");
        log.add(1.0, Weight::error, text);
    }
    log.note_read();
    REQUIRE(log.first_after(before, Weight::error));
    CHECK(log.first_after(before, Weight::error)->text == "two");
    CHECK(log.first_after(0, Weight::error)->text == "one");
    CHECK(log.first_after(before, Weight::warning) == nullptr);
    for (size_t i = 0; i < MessageLog::MAX_MESSAGES; ++i) log.add(2.0, Weight::done, "more");
    CHECK(log.first_after(0, Weight::error) == nullptr);
}

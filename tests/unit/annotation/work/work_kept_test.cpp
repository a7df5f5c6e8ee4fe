// Kept settings: they are no steps of the history, and return as they were left, whatever happened in between.

#include <algorithm>

#include <doctest/doctest.h>

#include "engine/annotation/work/work.h"
#include "tests/support/random_annotation.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

SettingValues seen_from(const std::string& view, const std::string& probe = "p0")
{
    return {{"cameras", view}, {"probe", probe}};
}

const SettingValues FRONT = seen_from("front");

class Desk : public TemporaryFolder {
public:
    WorkFiles files(const SettingValues& in_file = FRONT) const
    {
        WorkFiles files = files_in(path);
        files.kept = in_file;
        files.normalized_kept = [](const SettingValues& values) {
            for (const auto& [name, value] : values)
                if (value == "unreadable") fail(name, ": unreadable");
            return values;
        };
        return files;
    }
    std::unique_ptr<Work> open(const SettingValues& in_file = FRONT, const Work::Opening& opening = {}) const
    {
        auto work = std::make_unique<Work>(ANNOTATED_SIZE, ANNOTATED_TYPE);
        said.clear();
        for (const Notice& notice : work->open(files(in_file), opening)) said += notice.text + "\n";
        return work;
    }
    std::string journal() const { return bytes_of_file(files().journal); }
    mutable std::string said;
};

Command dab(uint16_t at)
{
    return {"dab", {MaskBrickChange{.brick = 0, .runs = {{at, at, 0, 1}}}}};
}

size_t count_of(RecordKind kind, const fs::path& journal)
{
    return size_t(std::ranges::count(scan_journal(journal).records, kind, &JournalRecord::kind));
}

}  // namespace

TEST_CASE("what is kept comes back, is no step, and leaves undo and redo as they are")
{
    const Desk desk;
    auto work = desk.open();
    CHECK(work->kept_settings() == FRONT);
    work->perform(dab(1));
    work->perform(dab(2));
    work->undo();
    work->keep_settings(seen_from("top"));
    CHECK(work->history().undoable() == 1);
    CHECK(work->history().redoable() == 1);
    CHECK(work->unsaved() == 3);
    work->keep_settings({{"probe", "p1"}});
    work.reset();
    work = desk.open();
    CHECK(work->kept_settings() == seen_from("top", "p1"));
    CHECK(!contains(desk.said, "were changed"));
    CHECK(work->redo()->label == "dab");
    CHECK(work->undo()->label == "dab");
    CHECK(work->kept_settings() == seen_from("top", "p1"));
    // Nothing differs: nothing is written.
    work->flush();
    const std::string before = desk.journal();
    work->keep_settings(seen_from("top", "p1"));
    work->keep_settings({});
    work->flush();
    CHECK(desk.journal() == before);
}

TEST_CASE("only looking leaves no file; what was kept before the first command goes with it")
{
    const Desk desk;
    {
        const auto work = desk.open();
        work->keep_settings(seen_from("top"));
        CHECK(work->kept_settings() == seen_from("top"));
        CHECK(work->is_saved());
    }
    CHECK(fs::is_empty(desk.path));
    CHECK(desk.open()->kept_settings() == FRONT);
    {
        const auto work = desk.open();
        work->keep_settings(seen_from("left"));
        work->perform(dab(1));
    }
    CHECK(desk.open()->kept_settings() == seen_from("left"));
    // If a journal exists, the settings are written at once, even without a command.
    desk.open()->keep_settings(seen_from("back"));
    const auto work = desk.open();
    CHECK(work->kept_settings() == seen_from("back"));
    CHECK(work->history().undoable() == 1);
    work.get()->settle();
    // Settings of work that is open for viewing only are never written.
    const std::string before = desk.journal();
    const auto looking = desk.open(FRONT, {.only_look = true});
    looking->keep_settings(seen_from("below"));
    CHECK(looking->kept_settings() == seen_from("below"));
    CHECK(desk.journal() == before);
}

TEST_CASE("a session's file that was changed since it was saved is believed, section by section")
{
    const Desk desk;
    {
        const auto work = desk.open();
        work->perform(dab(1));
        work->keep_settings(seen_from("top", "p1"));
        work->save({}, [] {});  // the session's file holds top, p1
        work->keep_settings(seen_from("left", "p2"));
    }
    CHECK(desk.open(seen_from("top", "p1"))->kept_settings() == seen_from("left", "p2"));
    CHECK(!contains(desk.said, "were changed"));
    // The camera is edited in the file.
    {
        const auto work = desk.open(seen_from("edited", "p1"));
        CHECK(contains(desk.said, "these settings of the session were changed since it was saved: cameras; they are"));
        CHECK(work->kept_settings() == seen_from("edited", "p2"));
        work->keep_settings({{"cameras", "moved on"}});
    }
    // The edit is remembered: the file is not new any more, whatever is kept since.
    CHECK(desk.open(seen_from("edited", "p1"))->kept_settings() == seen_from("moved on", "p2"));
    CHECK(!contains(desk.said, "were changed"));
    // A save that writes no session does not make its file older than it is.
    {
        const auto work = desk.open(seen_from("edited", "p1"));
        work->perform(dab(3));
        work->save();
    }
    CHECK(desk.open(seen_from("edited", "p1"))->kept_settings() == seen_from("moved on", "p2"));
    // A section that is missing in the file, or in the journal.
    CHECK(desk.open({{"probe", "p1"}})->kept_settings() == seen_from("moved on", "p2"));
    CHECK(desk.open({{"probe", "p1"}, {"new", "n"}})->kept_settings().at("new") == "n");
}

TEST_CASE("beside a journal of an older program the file is believed, until settings are kept there")
{
    const Desk desk;
    {
        WorkFiles older = desk.files();
        older.kept.clear();
        Work work(ANNOTATED_SIZE, ANNOTATED_TYPE);
        work.open(older);
        work.perform(dab(1));
    }
    CHECK(count_of(RecordKind::kept, desk.files().journal) == 0);
    {
        const auto work = desk.open();
        CHECK(work->kept_settings() == FRONT);
        work->keep_settings(seen_from("top"));
    }
    CHECK(desk.open()->kept_settings() == seen_from("top"));
    CHECK(!contains(desk.said, "were changed"));
    // The older program saves again and skips records that it does not know: its session file is believed.
    {
        WorkFiles older = desk.files();
        older.kept.clear();
        Work work(ANNOTATED_SIZE, ANNOTATED_TYPE);
        work.open(older);
        work.perform(dab(2));
        work.save({}, [] {});
    }
    CHECK(desk.open(seen_from("older"))->kept_settings() == seen_from("older"));
    CHECK(contains(desk.said, "were changed since it was saved: cameras;"));
}

TEST_CASE("kept settings that cannot be read are the file's, and it is told")
{
    const Desk desk;
    {
        const auto work = desk.open();
        work->perform(dab(1));
        work->keep_settings(seen_from("unreadable"));
    }
    {
        const auto work = desk.open();
        CHECK(work->kept_settings() == FRONT);
        CHECK(
            contains(desk.said, "its kept settings cannot be read: cameras: unreadable; those of the session's file"));
        CHECK(work->history().undoable() == 1);
        work->keep_settings(seen_from("top"));
    }
    CHECK(desk.open()->kept_settings() == seen_from("top"));
    CHECK(!contains(desk.said, "cannot be read"));
    for (const RecordNumber about : {RecordNumber{2}, RecordNumber{99}}) {
        Journal journal(desk.files().journal, scan_journal(desk.files().journal));
        journal.append(RecordKind::kept, {}, bytes_of(FRONT), about);
    }
    CHECK(desk.open(seen_from("file"))->kept_settings() == seen_from("file"));
    CHECK(contains(desk.said, "its kept settings cannot be read: record "));
}

TEST_CASE("opening reads few records, however often settings were kept; states hold all of them")
{
    const Desk desk;
    {
        const auto work = desk.open();
        work->set_limits({.steps_between_states = 50});
        work->perform(dab(1));
        for (int i = 0; i < 3000; ++i) work->keep_settings(seen_from(sentence("view ", i)));
        for (uint16_t i = 2; i < 400; ++i) work->perform(dab(uint16_t(2 * i)));
    }
    const JournalScan scan = scan_journal(desk.files().journal);
    size_t longest = 0, length = 0;
    for (size_t i = 0; i < scan.records.size(); ++i) {
        const JournalRecord& record = scan.records[i];
        if (record.kind == RecordKind::kept) longest = std::max(longest, length = record.about == 0 ? 0 : length + 1);
        if (record.kind == RecordKind::state && i > 3) CHECK(scan.records.at(i + 1).kind == RecordKind::kept);
    }
    CHECK(longest == 256);
    CHECK(count_of(RecordKind::state, desk.files().journal) >= 2);  // made in the background, the last when it closes
    CHECK(desk.open()->kept_settings() == seen_from("view 2999"));
}

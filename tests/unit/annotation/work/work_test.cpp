// The user's work is restored, whatever happened in between.

#include "engine/annotation/work/work.h"

#include <unistd.h>

#include <algorithm>
#include <random>

#include <doctest/doctest.h>

#include "engine/annotation/files/mask_file.h"
#include "tests/support/random_annotation.h"
#include "tests/support/slow.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

class Desk : public TemporaryFolder {
public:
    WorkFiles files() const { return files_in(path); }
    /// Reopens the work as it was left; messages from opening go to `said`.
    std::unique_ptr<Work> open(const Work::Opening& opening = {}) const
    {
        auto work = std::make_unique<Work>(ANNOTATED_SIZE, ANNOTATED_TYPE);
        said.clear();
        for (const Notice& notice : work->open(files(), opening)) said += notice.text + "\n";
        for (const Dispute& dispute : work->disputes()) said += dispute.text + "\n";
        return work;
    }
    uint64_t hash() const { return hash_of(open({.only_look = true})->document()); }
    mutable std::string said;
};

/// One more voxel of a group, at its own position.
Command dab(uint16_t at, uint8_t group = 1)
{
    return {"dab", {MaskBrickChange{.brick = 0, .runs = {{at, at, 0, group}}}}};
}

}  // namespace

TEST_CASE(
    "work at random, left and taken up again, is one history: every state comes back, to the first and to the last")
{
    for (uint32_t seed = 1; seed <= repeats(1u, 3u); ++seed) {
        CAPTURE(seed);
        const Desk desk;
        std::mt19937 random(seed);
        std::vector<uint64_t> states{hash_of(unannotated())};
        size_t at = 0, wrong = 0, reopened = 0, saved = 0, reverted = 0, kept_often = 0;
        std::optional<uint64_t> saved_state;
        SettingValues kept;
        auto work = desk.open();
        for (int step = 0; step < 1500; ++step) {
            // Memory for few commands, and frequent states, so that most undone commands are before the last state.
            work->set_limits({.history_bytes = 20000, .bytes_between_states = 3000, .steps_between_states = 40});
            const auto choice = random() % 46;
            if (choice < 11) {
                at -= work->undo() != nullptr;
            } else if (choice < 17) {
                at += work->redo() != nullptr;
            } else if (choice == 17) {
                work.reset();
                work = desk.open();
                if (states.size() == 1) kept.clear();  // nothing was done yet
                ++reopened;
            } else if (choice == 18) {
                work->save({}, [] {});
                CHECK(work->unsaved() == 0);
                saved_state = hash_of(work->document());
                ++saved;
            } else if (choice == 19) {
                if (!saved_state) {
                    CHECK(error_of([&] { work->revert(); }).empty() == (states.size() == 1));
                } else if (work->revert() != nullptr) {
                    states.resize(++at);
                    states.push_back(*saved_state);
                    ++reverted;
                }
                wrong += saved_state && hash_of(work->document()) != *saved_state;
            } else if (choice >= 40) {
                const SettingValues next = random_kept(random);
                for (const auto& [name, value] : next) kept[name] = value;
                work->keep_settings(next);
                ++kept_often;
            } else {
                Command command = random_command(work->document(), random);
                if (command.changes.empty()) continue;
                states.resize(++at);
                // A stroke: the remaining changes extend it.
                const size_t first = command.changes.size() > 1 && choice < 24 ? command.changes.size() / 2 : 0;
                std::vector<Change> rest;
                if (first > 0) rest.assign(command.changes.begin() + ptrdiff_t(first), command.changes.end());
                if (first > 0) command.changes.resize(first);
                work->perform(std::move(command));
                work->extend(std::move(rest));
                states.push_back(hash_of(work->document()));
            }
            wrong += hash_of(work->document()) != states[at] || work->history().undoable() != at ||
                     work->history().redoable() != states.size() - 1 - at || work->kept_settings() != kept;
        }
        CHECK(wrong == 0);
        CHECK(reopened > 10);
        CHECK(saved > 10);
        CHECK(reverted > 5);
        CHECK(kept_often > 50);
        work.reset();
        work = desk.open();
        while (work->redo()) wrong += hash_of(work->document()) != states[++at];
        CHECK(at == states.size() - 1);
        while (work->undo()) wrong += hash_of(work->document()) != states[--at];
        CHECK(at == 0);
        CHECK(wrong == 0);
        CHECK(hash_of(work->document()) == hash_of(unannotated()));
        work->flush();
        const JournalScan scan = scan_journal(desk.files().journal);
        CHECK(std::ranges::count(scan.records, RecordKind::state, &JournalRecord::kind) > 3);  // made in the background
    }
}

TEST_CASE("memory of the history is limited by its limit, and its commands come back from the journal")
{
    const Desk desk;
    const auto work = desk.open();
    work->set_limits({.history_bytes = 1000});
    for (uint16_t i = 0; i < 500; ++i) {
        work->perform(dab(uint16_t(2 * i)));
        if (i % 50 == 0) work->flush();
    }
    work->flush();
    work->perform(dab(2000));
    CHECK(work->history().memory_bytes() < 10000);
    CHECK(work->history().undoable() == 501);
    for (int i = 0; i < 501; ++i) REQUIRE(work->undo() != nullptr);
    CHECK(work->document().mask.painted_bricks().empty());
}

TEST_CASE("what was not saved is there, and it is said; what was saved needs no journal")
{
    const Desk desk;
    {
        const auto work = desk.open();
        CHECK(desk.said.empty());
        CHECK_FALSE(fs::exists(desk.files().journal));  // just looking creates no file
        work->perform(dab(1));
        work->save();
        work->perform(dab(2));
        work->perform(dab(3));
        CHECK(work->unsaved() == 2);
    }
    {
        const auto work = desk.open();
        CHECK(contains(desk.said, "a.journal: holds 2 steps that were not saved"));
        CHECK(work->unsaved() == 2);
        CHECK(work->document().mask.voxels_by_group()[1] == 3);
        CHECK(work->history().undoable() == 3);
        work->save();
    }
    const auto saved = desk.open();
    CHECK(desk.said.empty());
    const uint64_t hash = hash_of(saved->document());
    fs::remove(desk.files().journal);
    CHECK(desk.hash() == hash);
}

TEST_CASE("files that others changed are a question, and whatever the answer is, both are kept")
{
    const Desk desk;
    {
        const auto work = desk.open();
        work->perform(dab(1));
        work->save();
        work->perform(dab(2));
    }
    Mask other(ANNOTATED_SIZE);
    other.apply({.brick = 0, .runs = {{10, 19, 0, 7}}}, Direction::forwards);
    save_mask(desk.files().mask, other);
    const std::string journal = bytes_of_file(desk.files().journal), mask = bytes_of_file(desk.files().mask);
    {
        const auto work = desk.open();
        CHECK(contains(desk.said, "a.mask: was changed by another program; expected the mask as the journal"));
        REQUIRE(work->disputes().size() == 1);
        CHECK(work->document().mask.voxels_by_group()[1] == 2);
        CHECK_THROWS_AS(work->perform(dab(3)), Disputed);
        CHECK_THROWS_AS(work->undo(), Disputed);
        CHECK_THROWS_AS(work->save(), Disputed);
        CHECK(bytes_of_file(desk.files().journal) == journal);  // looking changes nothing
    }
    SUBCASE("the files: a step that undo takes back, and that is not asked about again")
    {
        auto work = desk.open({.belief = Belief::files});
        CHECK(contains(desk.said, "the file is taken, as a step that undo takes back"));
        CHECK(work->document().mask.voxels_by_group()[7] == 10);
        CHECK(work->document().mask.voxels_by_group()[1] == 0);
        work.reset();
        work = desk.open();
        CHECK(work->disputes().empty());
        CHECK(work->document().mask.voxels_by_group()[7] == 10);
        REQUIRE(work->undo());
        CHECK(work->document().mask.voxels_by_group()[1] == 2);
        CHECK(work->save().notices.empty());
        CHECK_FALSE(fs::exists(desk.path / "a.mask.old"));  // the journal holds it
    }
    SUBCASE("the journal: the next save keeps the file")
    {
        const auto work = desk.open({.belief = Belief::journal});
        CHECK(contains(desk.said, "the next save keeps the file as " + (desk.path / "a.mask.old").string()));
        const Work::Saved saved = work->save();
        REQUIRE(saved.notices.size() == 1);
        CHECK(saved.notices[0].is_loss);
        CHECK(bytes_of_file(desk.path / "a.mask.old") == mask);
        CHECK(work->document().mask.voxels_by_group()[1] == 2);
    }
    SUBCASE("only looking chooses for itself")
    {
        CHECK(desk.open({.belief = Belief::files, .only_look = true})->document().mask.voxels_by_group()[7] == 10);
        CHECK(bytes_of_file(desk.files().journal) == journal);
        CHECK(desk.open()->disputes().size() == 1);
    }
}

TEST_CASE("a missing file comes back from the journal, with its history, and it is said")
{
    const Desk desk;
    uint64_t hash = 0;
    {
        const auto work = desk.open();
        std::mt19937 random(5);
        while (work->document().trace.nodes().empty() || work->document().density.voxels() == 0 ||
               work->document().mask.painted_bricks().empty())
            if (Command command = random_command(work->document(), random); !command.changes.empty())
                work->perform(std::move(command));
        work->save();
        hash = hash_of(work->document());
    }
    const WorkFiles files = desk.files();
    for (const fs::path& file : {files.mask, files.trace, files.density}) {
        CAPTURE(file.string());
        const std::string before = bytes_of_file(file);
        fs::remove(file);
        const auto work = desk.open();
        CHECK(contains(desk.said, file.string() + ": is missing; expected the "));
        CHECK(hash_of(work->document()) == hash);
        CHECK(work->history().undoable() > 0);
        work->save();
        CHECK(bytes_of_file(file) == before);
    }
    CHECK(desk.hash() == hash);
    CHECK(desk.said.empty());
}

TEST_CASE("what others write while the work is open is kept by the next save")
{
    const Desk desk;
    const auto work = desk.open();
    work->perform(dab(1));
    CHECK(work->save().notices.empty());
    desk.write("a.mask", "of somebody else");
    work->perform(dab(2));
    const Work::Saved saved = work->save();
    REQUIRE(saved.notices.size() == 1);
    CHECK(contains(saved.notices[0].text, "a.mask: was written by another program"));
    CHECK(bytes_of_file(desk.path / "a.mask.old") == "of somebody else");
    CHECK(work->save().notices.empty());
    // The trace has not been changed, so it is not written, and the foreign file is a question at the next start.
    desk.write("a.graphml", "of somebody else");
    work->perform(dab(3));
    CHECK(work->save().notices.empty());
    CHECK(bytes_of_file(desk.files().trace) == "of somebody else");
}

TEST_CASE("a journal that is removed while it is written is put back, with all that it held")
{
    const Desk desk;
    auto work = desk.open();
    work->perform(dab(1));
    work->flush();
    fs::remove(desk.files().journal);
    work->perform(dab(3));
    work->flush();
    CHECK(desk.open({.only_look = true})->document().mask.voxels_by_group()[1] == 2);
    desk.write("other", "no journal");
    fs::rename(desk.path / "other", desk.files().journal);
    work->save();
    CHECK(bytes_of_file(desk.path / "a.journal.old") == "no journal");
    work->undo();
    work.reset();
    work = desk.open();
    CHECK(work->document().mask.voxels_by_group()[1] == 1);
    CHECK(work->history().undoable() == 1);
    CHECK(work->history().redoable() == 1);
}

TEST_CASE("a save that came to no end is of either state, and the journal knows which is last")
{
    const Desk desk;
    uint64_t hash = 0;
    {
        const auto work = desk.open();
        work->perform(dab(1));
        work->save();
        work->perform(dab(2));
        hash = hash_of(work->document());
        // The second file cannot be written.
        const WorkFiles files = desk.files();
        work->name_files(files.mask, files.trace, desk.path / "none" / "a.offset");
        work->perform({"offset", {DensityBrickChange{.brick = 0, .runs = {{5, 5, 0, 9}}}}});
        CHECK(contains(error_of([&] { work->save(); }), "a.offset: cannot be written: No such file or directory"));
        CHECK(work->unsaved() == 2);
        work->undo();
    }
    CHECK(desk.hash() == hash);
    CHECK(contains(desk.said, "holds 3 steps that were not saved"));
    CHECK(desk.open()->disputes().empty());  // the mask is that of the save that came to no end
}

TEST_CASE("starting afresh leaves the journal there was under another name")
{
    const Desk desk;
    desk.open()->perform(dab(1));
    const std::string journal = bytes_of_file(desk.files().journal);
    {
        const auto work = desk.open({.start = Work::Start::fresh});
        CHECK(work->document().mask.painted_bricks().empty());
        CHECK(bytes_of_file(desk.files().journal) == journal);
        work->perform(dab(5, 2));
    }
    CHECK(bytes_of_file(desk.path / "a.journal.old") == journal);
    const auto work = desk.open();
    CHECK(work->document().mask.voxels_by_group()[2] == 1);
    CHECK(work->document().mask.voxels_by_group()[1] == 0);
}

TEST_CASE("a journal of another volume is refused by what differs")
{
    const Desk desk;
    desk.open()->perform(dab(1));
    const auto refusal = [&](const Size3& size, VoxelType type, const std::string& hash) {
        Work work(size, type);
        WorkFiles files = desk.files();
        files.volume_hash = hash;
        return error_of([&] { work.open(files); });
    };
    const std::string hash = desk.files().volume_hash;
    CHECK(contains(refusal({45, 40, 36}, ANNOTATED_TYPE, hash),
                   "a.journal: is of a volume of 45x40x35 voxels of int16; expected 45x40x36 voxels of int16"));
    CHECK(contains(refusal(ANNOTATED_SIZE, VoxelType::uint8, hash), "expected 45x40x35 voxels of uint8"));
    CHECK(contains(refusal(ANNOTATED_SIZE, ANNOTATED_TYPE, "xxh3-128:1"), "is of an image with the hash " + hash));
    CHECK(refusal(ANNOTATED_SIZE, ANNOTATED_TYPE, "").empty());
}

TEST_CASE("a second hand is told at opening who writes, and may look")
{
    const Desk desk;
    auto first = desk.open({.program = "the first"});
    const std::string refusal = error_of([&] { desk.open(); });
    CHECK(contains(refusal, sentence("a.journal: is open for writing in the first, process ", ::getpid(), " on ")));
    CHECK_THROWS_AS(desk.open(), JournalTaken);
    first->perform(dab(1));
    first->flush();
    const auto looking = desk.open({.only_look = true});
    CHECK(looking->only_looks());
    CHECK(looking->document().mask.voxels_by_group()[1] == 1);
    CHECK_THROWS_AS(looking->perform(dab(2)), JournalTaken);
    CHECK_THROWS_AS(looking->undo(), JournalTaken);
    CHECK_THROWS_AS(looking->save(), JournalTaken);
    CHECK_THROWS_AS(looking->refuse_if_only_looking(), JournalTaken);
    CHECK_NOTHROW(first->refuse_if_only_looking());
    const auto told = desk.open({.only_look = true, .why_only_look = "The scan is read only"});
    CHECK(error_of([&] { told->perform(dab(2)); }) == "The scan is read only");
    REQUIRE(holder_of(desk.files().journal).has_value());
    CHECK(holder_of(desk.files().journal)->program == "the first");
    // The work that replaces the first takes over its hold.
    first->settle();
    auto second = desk.open({.hold = first->hold()});
    first.reset();
    second->perform(dab(3));
    CHECK_THROWS_AS(desk.open(), JournalTaken);
    second.reset();
    CHECK_FALSE(holder_of(desk.files().journal).has_value());
    CHECK_FALSE(fs::exists(lock_path(desk.files().journal)));
    // A lock file of a dead process is no hold.
    desk.write("a.journal.lock", "program: shvr view\nprocess: 999999999\n");
    CHECK_FALSE(holder_of(desk.files().journal).has_value());
    CHECK(desk.open()->document().mask.voxels_by_group()[1] == 2);
}

TEST_CASE("without locks, who comes second is refused at opening")
{
    const Desk desk;
    fs::create_directory(lock_path(desk.files().journal));  // so that no lock can be kept
    auto first = desk.open({.program = "the first"});
    CHECK_THROWS_AS(desk.open(), JournalTaken);
    CHECK(contains(error_of([&] { desk.open(); }), "a.journal: is open for writing in the first, process "));
    first->perform(dab(1));
    CHECK_THROWS_AS(desk.open(), JournalTaken);
    REQUIRE(holder_of(desk.files().journal).has_value());
    CHECK(holder_of(desk.files().journal)->program == "the first");
    first.reset();
    CHECK_FALSE(holder_of(desk.files().journal).has_value());
    CHECK(desk.open()->document().mask.voxels_by_group()[1] == 1);
}

TEST_CASE("a journal whose checksums hold and whose records do not fit is taken as far as it fits")
{
    const Desk desk;
    {
        const auto work = desk.open();
        work->set_clock([] { return int64_t(0); });  // one record of the time, however slow the machine is
        work->perform(dab(1));
        work->perform(dab(2));
    }
    const std::string good = bytes_of_file(desk.files().journal);
    const auto check = [&](RecordKind kind, std::vector<std::byte> content, RecordNumber about, const char* why) {
        desk.write("a.journal", good);
        {
            Journal journal(desk.files().journal, scan_journal(desk.files().journal));
            journal.append(kind, "hostile", std::move(content), about);
            journal.append(RecordKind::command, "after", bytes_of(dab(9).changes));
        }
        const auto work = desk.open();
        CAPTURE(std::string(why));
        CAPTURE(desk.said);
        CHECK(contains(desk.said, std::string("record 9 cannot be applied: ") + why));
        CHECK(contains(desk.said, "; what comes before is used"));
        CHECK(work->document().mask.voxels_by_group()[1] == 2);
        CHECK(work->history().undoable() == 2);
        work->perform(dab(4));
        work->flush();
        CHECK(desk.hash() == hash_of(work->document()));
        CHECK(fs::remove(desk.path / "a.journal.rest1"));
    };
    check(RecordKind::command, bytes_of(dab(1).changes), 0, "brick 0 does not hold group 0 at 1 ... 1");
    check(RecordKind::extension, std::vector(3, std::byte(99)), 0, "a change is of kind 99; expected 1 to 7");
    check(RecordKind::redo, {}, 0, "more commands are redone than were undone");
    check(RecordKind::state, bytes_of(unannotated()), 9, "a state is of record 9 behind it");
    check(RecordKind::state, std::vector(1, std::byte(1)), 5, "it ends too early");
    check(RecordKind::respaced, std::vector(24, std::byte(0)), 0, "a voxel's side is 0; expected a number above 0");
}

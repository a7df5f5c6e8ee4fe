// Another writer of which it is unknown whether it has ended: both journals are kept, and both report.

#include <unistd.h>

#include <doctest/doctest.h>

#include "engine/annotation/work/work.h"
#include "tests/support/random_annotation.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

class Desk : public TemporaryFolder {
public:
    WorkFiles files() const { return files_in(path); }
    std::unique_ptr<Work> open(const Work::Opening& opening = {}) const
    {
        auto work = std::make_unique<Work>(ANNOTATED_SIZE, ANNOTATED_TYPE);
        said.clear();
        losses = 0;
        for (const Notice& notice : work->open(files(), opening)) {
            said += notice.text + "\n";
            losses += notice.is_loss;
        }
        return work;
    }
    fs::path journal() const { return files().journal; }
    /// The mark of the only writer.
    fs::path mark() const
    {
        fs::path found;
        for (const fs::directory_entry& entry : fs::directory_iterator(path)) {
            const std::string name = entry.path().filename().string();
            if (!name.ends_with(".lock") || name == "a.journal.lock") continue;
            REQUIRE(found.empty());
            found = entry.path();
        }
        return found;
    }
    mutable std::string said;
    mutable size_t losses = 0;
};

Command dab(uint16_t at, uint8_t group = 1)
{
    return {"dab", {MaskBrickChange{.brick = 0, .runs = {{at, at, 0, group}}}}};
}

int64_t painted(const Work& work)
{
    return work.document().mask.voxels_by_group()[1];
}

constexpr char ELSEWHERE[] = "a.journal.node7.4711.1a2b3c4d.4026531836.8812.99.0.lock";

}  // namespace

TEST_CASE("a journal that another computer may still write is left to it, and work continues in a copy")
{
    const Desk desk;
    desk.open()->perform(dab(1));
    const std::string before = bytes_of_file(desk.journal());
    desk.write(ELSEWHERE, "program: shvr view\nprocess: 4711\nhost: node7\nuser: ada\nsince: 2026-11-22 13:20:05\n");
    REQUIRE(holder_of(desk.journal()).has_value());
    CHECK(in_words(*holder_of(desk.journal())) ==
          "shvr view, process 4711 on node7 of user ada, since 2026-11-22 13:20:05, if that has not ended");
    {
        const auto work = desk.open();
        CHECK(contains(desk.said, "a.journal: is open for writing in shvr view, process 4711 on node7"));
        CHECK(contains(desk.said, "leaves this file to it, as " + (desk.path / "a.journal.old").string()));
        CHECK(desk.losses == 1);
        // Looking changes nothing.
        work->keep_settings({{"cameras", "{}"}});
        CHECK(bytes_of_file(desk.journal()) == before);
        CHECK(fs::exists(desk.path / ELSEWHERE));
        work->perform(dab(2));
        work->flush();
        CHECK_FALSE(fs::exists(desk.path / ELSEWHERE));
        CHECK(bytes_of_file(desk.path / "a.journal.old") == before);
        CHECK(painted(*work) == 2);
        work->undo();
        work->undo();
        CHECK(painted(*work) == 0);
    }
    const auto again = desk.open();
    CHECK(desk.losses == 0);
    again->redo();
    again->redo();
    CHECK(painted(*again) == 2);
    CHECK(fs::exists(desk.path / "a.journal.old"));
}

TEST_CASE("a writer that closes meanwhile leaves its journal to the next")
{
    const Desk desk;
    desk.open()->perform(dab(1));
    desk.write(ELSEWHERE, "");
    const auto work = desk.open();
    CHECK(contains(desk.said, "process 4711 on node7, since 2"));
    fs::remove(desk.path / ELSEWHERE);
    work->perform(dab(2));
    CHECK_FALSE(fs::exists(desk.path / "a.journal.old"));
    CHECK(painted(*work) == 2);
}

TEST_CASE("a writer whose mark a third one revokes meanwhile is left its journal, too")
{
    const Desk desk;
    desk.open()->perform(dab(1));
    const std::string before = bytes_of_file(desk.journal());
    desk.write(ELSEWHERE, "");
    const auto work = desk.open();
    const fs::path mark = desk.path / ELSEWHERE;
    fs::rename(mark, fs::path(mark).replace_extension(".revoked.lock"));
    work->perform(dab(2));
    work->flush();
    CHECK(bytes_of_file(desk.path / "a.journal.old") == before);
    CHECK(painted(*work) == 2);
}

namespace {

/// The journal of a writer elsewhere, which grows by a step each time the opening of another tells its progress.
struct Growing {
    explicit Growing(const Desk& desk)
    {
        const auto work = desk.open();
        constexpr uint16_t STEPS = 70, LATER = 4;  // progress is told every 64 records
        for (uint16_t at = 1; at <= STEPS + LATER; ++at) {
            work->perform(dab(at));
            work->flush();
            if (at >= STEPS) states.push_back(bytes_of_file(desk.journal()));
        }
    }
    std::vector<std::string> states;  ///< its first 70, 71, ... steps
    size_t state = 0;
};

}  // namespace

TEST_CASE("a journal that is written while it is taken over is read again")
{
    const Desk desk;
    Growing growing(desk);
    desk.write("a.journal", growing.states[0]);
    desk.write(ELSEWHERE, "");
    const auto grow_once = [&](double) {
        if (growing.state == 0) desk.write("a.journal", growing.states[++growing.state]);
    };
    const auto work = desk.open({.takes_over = true, .progress = grow_once});
    REQUIRE(growing.state == 1);
    CHECK(contains(desk.said, "process 4711 on node7, since 2"));
    CHECK(painted(*work) == 71);
    CHECK_FALSE(fs::exists(desk.path / ELSEWHERE));
    CHECK(bytes_of_file(desk.path / "a.journal.old") == growing.states[1]);
    work->perform(dab(100));
    CHECK(painted(*work) == 72);
}

TEST_CASE("work that starts afresh leaves the journal to those who may still write it")
{
    for (const bool takes_over : {false, true}) {
        CAPTURE(takes_over);
        const Desk desk;
        desk.open()->perform(dab(1));
        const std::string before = bytes_of_file(desk.journal());
        desk.write(ELSEWHERE, "");
        {
            const auto work = desk.open({.start = Work::Start::fresh, .takes_over = takes_over});
            CHECK(fs::exists(desk.path / ELSEWHERE) == !takes_over);
            work->perform(dab(2));
            work->perform(dab(3));
        }
        CHECK(bytes_of_file(desk.path / "a.journal.old") == before);
        CHECK_FALSE(fs::exists(desk.path / ELSEWHERE));
        CHECK_FALSE(fs::exists(desk.path / "a.journal.old2"));
        CHECK(painted(*desk.open()) == 2);
    }
}

TEST_CASE("a journal that is written whenever it is read is not taken over for ever")
{
    const Desk desk;
    Growing growing(desk);
    desk.write("a.journal", growing.states[0]);
    desk.write(ELSEWHERE, "");
    const auto grow = [&](double) {
        REQUIRE(growing.state + 1 < growing.states.size());
        desk.write("a.journal", growing.states[++growing.state]);
    };
    CHECK_THROWS_AS(desk.open({.takes_over = true, .progress = grow}), JournalTaken);
    CHECK(growing.state == 3);
    CHECK(bytes_of_file(desk.journal()) == growing.states[3]);
}

TEST_CASE("a journal that grew since it was read is claimed from nobody")
{
    const Desk desk;
    desk.open()->perform(dab(1));
    desk.write(ELSEWHERE, "");
    const auto work = desk.open();
    const std::string longer = bytes_of_file(desk.journal()) + "more";
    desk.write("a.journal", longer);
    CHECK_THROWS_AS(work->perform(dab(2)), JournalTaken);
    CHECK(bytes_of_file(desk.journal()) == longer);
    CHECK(fs::exists(desk.path / ELSEWHERE));
}

TEST_CASE("who has lost the journal is told at the next command, and what it did is kept under the name it got")
{
    const Desk desk;
    const auto work = desk.open();
    work->perform(dab(1));
    work->flush();
    const fs::path mark = desk.mark();
    REQUIRE_FALSE(mark.empty());
    // As another process does it.
    fs::rename(desk.journal(), desk.path / "a.journal.old");
    desk.write("a.journal", "another");
    fs::remove(mark);
    desk.write(ELSEWHERE, "program: shvr view\nprocess: 4711\nhost: node7\n");
    const std::string refusal = error_of([&] { work->perform(dab(2)); });
    CHECK(contains(refusal, "a.journal: was taken over by shvr view, process 4711 on node7"));
    CHECK(contains(refusal, "what was done here is kept in " + (desk.path / "a.journal.old").string()));
    CHECK(work->only_looks());
    CHECK(work->is_kept());  // so it can be closed
    CHECK_THROWS_AS(work->undo(), JournalTaken);
    CHECK_THROWS_AS(work->save(), JournalTaken);
    CHECK(painted(*work) == 1);
    CHECK(bytes_of_file(desk.journal()) == "another");
    CHECK_FALSE(fs::exists(desk.files().mask));
}

TEST_CASE("who has lost the journal without another command learns it from its last write")
{
    const Desk desk;
    const auto work = desk.open();
    work->perform(dab(1));
    work->flush();
    CHECK_FALSE(work->look_for_claim());
    fs::remove(desk.mark());
    fs::remove(desk.journal());
    work->extend(dab(2).changes);
    CHECK_THROWS_AS(work->flush(), JournalTaken);
    CHECK(contains(work->claimed(), "is kept in " + (desk.path / "a.journal.old").string()));
    CHECK(painted(*work) == 2);
    fs::rename(desk.path / "a.journal.old", desk.journal());
    CHECK(painted(*desk.open({.only_look = true})) == 2);
}

TEST_CASE("marks of processes that have ended, and copies of marks, hold nothing and are removed")
{
    const Desk desk, copied;
    {
        const auto work = desk.open();
        work->perform(dab(1));
        work->flush();
        fs::copy(desk.path, copied.path, fs::copy_options::recursive | fs::copy_options::overwrite_existing);
    }
    CHECK(desk.mark().empty());
    CHECK_FALSE(copied.mark().empty());
    CHECK_FALSE(holder_of(copied.journal()).has_value());
    CHECK(painted(*copied.open()) == 1);
    CHECK(copied.losses == 0);
    CHECK(copied.mark().empty());
}

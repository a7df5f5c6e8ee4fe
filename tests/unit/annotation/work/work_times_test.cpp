// Times of steps: noted in the journal, never part of the work.

#include <algorithm>
#include <fstream>

#include <doctest/doctest.h>

#include "engine/annotation/work/work.h"
#include "tests/support/random_annotation.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

constexpr int64_t NOON = 1795953600000;  // 2026-11-29T12:00:00Z

Command dab(uint16_t at, uint8_t group = 1)
{
    return {"dab", {MaskBrickChange{.brick = 0, .runs = {{at, at, 0, group}}}}};
}

size_t count_of(RecordKind kind, const fs::path& journal)
{
    return size_t(std::ranges::count(scan_journal(journal).records, kind, &JournalRecord::kind));
}

/// Opens work whose clock stands at `now_ms`.
std::unique_ptr<Work> opened(const WorkFiles& files, const int64_t& now_ms)
{
    auto work = std::make_unique<Work>(ANNOTATED_SIZE, ANNOTATED_TYPE);
    work->set_clock([&now_ms] { return now_ms; });
    work->open(files);
    return work;
}

}  // namespace

TEST_CASE("each step has the time at which it was begun, also after it was left and undone")
{
    const TemporaryFolder desk;
    const WorkFiles files = files_in(desk.path);
    int64_t now = NOON;
    auto work = opened(files, now);
    work->perform(dab(1));
    now += 2500;
    work->perform(dab(2));
    now += 1000;
    work->extend(dab(3).changes);  // the stroke goes on; it was begun before
    now += 60000;
    work->undo();
    const auto check_times = [&] {
        CHECK(work->time_of(0) == NOON);
        CHECK(work->time_of(1) == NOON + 2500);
    };
    check_times();
    work.reset();
    now += 3600000;
    work = opened(files, now);
    REQUIRE(work->history().redoable() == 1);
    check_times();
    work->redo();
    check_times();
    work->perform(dab(9));
    CHECK(work->time_of(2) == now);
}

// Kind (Journal): a clock that is set back, and steps faster than it is noted
TEST_CASE("times are noted ten times a second at most, and where the clock is set back")
{
    const TemporaryFolder desk;
    const WorkFiles files = files_in(desk.path);
    int64_t now = NOON;
    auto work = opened(files, now);
    for (uint16_t i = 0; i < 100; ++i) {
        work->perform(dab(i));
        now += 10;
    }
    CHECK(work->time_of(99) == NOON + 900);  // within a tenth of a second of NOON + 990
    now -= 7200000;
    work->perform(dab(200));
    CHECK(work->time_of(100) == now);
    CHECK(work->time_of(99) == NOON + 900);
    work->flush();
    CHECK(count_of(RecordKind::time, files.journal) == 11);
}

// Kind (Journal): the same work at other times
TEST_CASE("equal work at other times is equal")
{
    const TemporaryFolder first_desk, second_desk;
    uint64_t hashes[2];
    size_t steps[2];
    for (int i = 0; i < 2; ++i) {
        const WorkFiles files = files_in((i == 0 ? first_desk : second_desk).path);
        int64_t now = i == 0 ? NOON : -5000;  // before 1970
        auto work = opened(files, now);
        for (uint16_t at = 0; at < 5; ++at) {
            work->perform(dab(at));
            now += 400 * (i + 1);
        }
        work->undo();
        CHECK(work->time_of(0) == (i == 0 ? NOON : -5000));
        work.reset();
        work = opened(files, now);
        hashes[i] = hash_of(work->document());
        steps[i] = work->history().undoable();
    }
    CHECK(hashes[0] == hashes[1]);
    CHECK(steps[0] == steps[1]);
}

// Kind (Journal): a journal of a program that noted no times
TEST_CASE("a journal without times opens and goes on, and its old steps have no time")
{
    const TemporaryFolder desk;
    WorkFiles files = files_in(desk.path);
    files.volume_hash.clear();
    files.volume.size = Size3(24);
    files.volume.type = VoxelType::uint8;
    files.volume.spacing = glm::dvec3(1.0);
    files.volume.unit = "voxel";
    fs::copy_file("tests/data/journals/untimed.journal", files.journal);
    int64_t now = NOON;
    const auto open = [&] {
        auto work = std::make_unique<Work>(Size3(24), VoxelType::uint8);
        work->set_clock([&now] { return now; });
        work->open(files);
        return work;
    };
    auto work = open();
    REQUIRE(work->history().undoable() == 4);
    CHECK(work->document().trace.nodes().size() == 2);
    CHECK(work->document().mask.voxels_by_group()[3] > 100);
    CHECK(work->document().mask.voxels_by_group()[4] > 50);
    CHECK(work->history().label_of(0).find("group 3") != std::string::npos);
    for (size_t step = 0; step < 4; ++step) CHECK_FALSE(work->time_of(step));
    work->undo();
    work->perform(dab(1, 7));
    for (int i = 0; i < 2; ++i, work.reset(), work = open()) {
        REQUIRE(work->history().undoable() == 4);
        CHECK_FALSE(work->time_of(2));
        CHECK(work->time_of(3) == NOON);
    }
}

// Kind (Journal): a time of a wrong length
TEST_CASE("a time that is none is refused where it is asked for, and the work stays")
{
    const TemporaryFolder desk;
    const WorkFiles files = files_in(desk.path);
    int64_t now = NOON;
    opened(files, now)->perform(dab(1));
    {
        Journal journal(files.journal, scan_journal(files.journal));
        journal.append(RecordKind::time, {}, std::vector(3, std::byte(1)));
        journal.append(RecordKind::command, "after", bytes_of(dab(9).changes));
    }
    const auto work = opened(files, now);
    CHECK(work->history().undoable() == 2);
    CHECK(work->time_of(0) == NOON);
    CHECK(error_of([&] { static_cast<void>(work->time_of(1)); }).find("holds no time: it ends too early") !=
          std::string::npos);
}

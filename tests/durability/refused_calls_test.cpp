// Lets each file-changing call of a save or the journal fail once, in every way a disk can fail: the files are whole,
// old or new; no work is lost; and the next try succeeds.

#include <atomic>
#include <cerrno>
#include <chrono>
#include <map>
#include <thread>

#include <doctest/doctest.h>

#include "engine/annotation/files/mask_image.h"
#include "tests/durability/desk.h"
#include "tests/durability/watched_calls.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

/// All files except the journal's, by name.
std::map<std::string, std::string> saved_files(const fs::path& folder)
{
    std::map<std::string, std::string> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (!contains(name, "journal")) files[name] = bytes_of_file(entry.path());
    }
    return files;
}

}  // namespace

TEST_CASE("every call of a save fails once: each file is the old or the new one, and a second try succeeds")
{
    const TemporaryFolder folder;
    int max_calls = 0, refused_saves = 0;
    using Kind = FileCall::Kind;
    for (const int error : {ENOSPC, EIO, EROFS, EINTR, SHORT_WRITE}) {
        const auto can_happen = [&](Kind kind) {
            if (error == EINTR) return kind == Kind::write || kind == Kind::sync || kind == Kind::sync_folder;
            return error != SHORT_WRITE || kind == Kind::write;
        };
        for (int nth = 0; nth < 1000; nth += error == EIO ? 1 : 3) {
            CAPTURE(error);
            CAPTURE(nth);
            const fs::path desk = folder.path / "desk";
            fs::remove_all(desk);
            fs::create_directory(desk);
            std::string said;
            std::mt19937 random(3);
            auto work = open_work(files_in(desk), said);
            for (int i = 0; i < 12; ++i) random_step(*work, random);
            work->save();
            const auto before = saved_files(desk);
            for (int i = 0; i < 12; ++i) random_step(*work, random);
            work->flush();
            const uint64_t hash = hash_of(work->document());

            int calls = 0;
            refuse_calls(desk,
                         [&](const FileCall& call) { return can_happen(call.kind) && calls++ == nth ? error : 0; });
            const std::string refused = error_of([&] { work->save(); });
            refuse_calls(desk, {});
            const auto between = saved_files(desk);
            REQUIRE(hash_of(work->document()) == hash);
            work->save();
            const auto after = saved_files(desk);
            if (!refused.empty()) {
                ++refused_saves;
                CHECK(contains(refused, desk.string()));
                CHECK((contains(refused, "cannot be ") || contains(refused, "could not")));
            }
            CHECK((between.size() >= before.size() && between.size() <= after.size()));
            // MASK.json says which save it is of, and that is in the journal.
            const std::optional<MaskJournal> named = journal_of_mask(files_in(desk).mask);
            const JournalScan scan = scan_journal(files_in(desk).journal);
            REQUIRE(named.has_value());
            REQUIRE(named->record <= scan.records.size());
            CHECK(scan.records[named->record - 1].kind == RecordKind::saving);
            CHECK(scan.records[named->record - 1].checksum == named->checksum);
            for (const auto& [name, content] : between)
                if (name != "a.mask.json")
                    CHECK_MESSAGE(((before.contains(name) && before.at(name) == content) || after.at(name) == content),
                                  name);
            // Interrupted and short calls are continued.
            if (error == EINTR || error == SHORT_WRITE) CHECK(refused.empty());
            work.reset();
            work = open_work(files_in(desk), said);
            CHECK(hash_of(work->document()) == hash);
            CHECK(said.empty());
            max_calls = std::max(max_calls, calls);
            if (calls <= nth) break;
        }
    }
    CHECK(max_calls > 15);
    CHECK(refused_saves > 30);
    MESSAGE("at most ", max_calls, " calls; ", refused_saves, " saves refused in words");
}

TEST_CASE("a full disk stops nobody: work goes on in memory, it is said, and the journal catches up")
{
    for (const int error : {ENOSPC, EIO}) {
        CAPTURE(error);
        const TemporaryFolder folder;
        std::string said;
        std::mt19937 random(9);
        auto work = open_work(files_in(folder.path), said);
        for (int i = 0; i < 20; ++i) random_step(*work, random);
        work->flush();
        const size_t steps_before = steps_in(files_in(folder.path).journal);
        // Half of a record is written, or no record can be synced.
        int writes = 0;
        refuse_calls(folder.path, [&](const FileCall& call) {
            if (call.kind == FileCall::Kind::write && error == ENOSPC) return writes++ == 0 ? SHORT_WRITE : error;
            return call.kind == FileCall::Kind::sync ? error : 0;
        });
        for (int i = 0; i < 50; ++i) random_step(*work, random);
        const std::string refused = error_of([&] { work->flush(); });
        CHECK(contains(refused, error == ENOSPC ? "a.journal: cannot be written: No space left on device"
                                                : "a.journal: cannot be synced: Input/output error"));
        CHECK(work->journal().failure == refused);
        // Another reader meanwhile finds at least the durable steps.
        CHECK(steps_in(files_in(folder.path).journal) >= steps_before);
        const uint64_t hash = hash_of(work->document());
        refuse_calls(folder.path, {});
        work->flush();
        CHECK(work->journal().failure.empty());
        CHECK(hash_of(open_work(files_in(folder.path), said, {.only_look = true})->document()) == hash);
        for (int i = 0; i < 5; ++i) random_step(*work, random);
        work.reset();
    }
}

TEST_CASE(
    "a journal that cannot be begun takes no command; one that cannot be synced keeps it in memory, and catches up")
{
    const TemporaryFolder folder;
    int taken = 0;
    for (int nth = 0; nth < 100; ++nth) {
        CAPTURE(nth);
        std::string said;
        auto work = open_work(files_in(folder.path), said);
        std::atomic<int> calls = 0;
        refuse_calls(folder.path, [&](const FileCall&) { return calls++ == nth ? EROFS : 0; });
        std::mt19937 random(4);
        std::string refused;
        while (work->history().undoable() == 0 && refused.empty())
            refused = error_of([&] { random_step(*work, random); });
        if (!refused.empty()) {
            CHECK(contains(refused, "a.journal: "));
            CHECK(contains(refused, reason_of(EROFS)));
            CHECK(hash_of(work->document()) == hash_of(unannotated()));
            CHECK_FALSE(fs::exists(files_in(folder.path).journal));
        } else {
            ++taken;
            const std::string unsynced = error_of([&] { work->flush(); });
            if (!unsynced.empty()) CHECK(contains(unsynced, "unsaved work stays in memory"));
        }
        const bool was_last = refused.empty() && calls <= nth;
        refuse_calls(folder.path, {});
        if (refused.empty()) {
            work->flush();
            const uint64_t hash = hash_of(work->document());
            work.reset();
            CHECK(hash_of(open_work(files_in(folder.path), said)->document()) == hash);
        }
        work.reset();
        fs::remove(files_in(folder.path).journal);
        if (was_last) {
            CHECK(nth > 3);
            CHECK(taken > 2);
            return;
        }
    }
    FAIL("a journal needs more than 100 calls to begin");
}

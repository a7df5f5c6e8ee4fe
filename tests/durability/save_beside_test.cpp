// Kills the program at random moments while a save runs in the background: files are those of the last completed save
// or of the interrupted one, the journal knows them, and no step is lost except those of the last moments.

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <thread>

#include <doctest/doctest.h>

#include "tests/durability/desk.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

struct Told {
    std::atomic<size_t> steps, saves;
};

/// Steps without end; one save after the other on a thread of its own.
[[noreturn]] void work_until_killed(const fs::path& folder, uint32_t seed, Told& told)
{
    std::string said;
    const auto work = open_work(files_in(folder), said);
    std::mt19937 random(seed);
    std::unique_ptr<Work::Saving> saving;
    std::atomic<bool> is_written = false;
    std::thread writer;
    for (;;) {
        work->perform(random_command(work->document(), random));
        ++told.steps;
        if (saving && is_written) {
            writer.join();
            work->end_save(*saving);
            saving.reset();
            ++told.saves;
        }
        if (!saving) {
            saving = work->begin_save({});
            is_written = false;
            writer = std::thread([&] {
                saving->write();
                is_written = true;
            });
        }
        std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
}

}  // namespace

TEST_CASE("100 kills during saves beside the work: nothing is disputed, and what was done meanwhile stays unsaved")
{
    const TemporaryFolder folder;
    const WorkFiles files = files_in(folder.path);
    auto* const told =
        static_cast<Told*>(::mmap(nullptr, sizeof(Told), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
    REQUIRE(told != MAP_FAILED);
    std::mt19937 random(1);
    size_t disputed = 0, unexplained = 0, amid_save = 0, behind = 0, saves = 0;
    for (uint32_t round = 0; round < 100; ++round) {
        told->steps = told->saves = 0;
        const pid_t child = ::fork();
        REQUIRE(child >= 0);
        if (child == 0) work_until_killed(folder.path, round, *told);
        while (told->steps == 0) std::this_thread::sleep_for(std::chrono::microseconds(100));
        std::this_thread::sleep_for(std::chrono::microseconds(random() % 60000));
        ::kill(child, SIGKILL);
        int status = 0;
        REQUIRE(::waitpid(child, &status, 0) == child);
        saves += told->saves;

        // The files hold a state that the journal knows: that of the last save, or of one that had begun.
        const JournalScan scan = scan_journal(files.journal);
        size_t since_saving = 0;
        bool is_amid = false;
        for (const JournalRecord& record : scan.records) {
            if (record.kind == RecordKind::saving) is_amid = true, since_saving = 0;
            if (record.kind == RecordKind::saved) is_amid = false;
            since_saving += record.kind == RecordKind::command;
        }
        amid_save += is_amid;
        std::string said;
        const auto work = open_work(files, said);
        disputed += !work->disputes().empty() || contains(said, "was changed") || contains(said, "was put there");
        if (!is_amid && scan.records.back().kind != RecordKind::saved) {
            behind += since_saving > 0;
            unexplained += work->unsaved() != since_saving;
        }
        work->save();
        unexplained += !work->is_saved();
    }
    ::munmap(told, sizeof(Told));
    CHECK(disputed == 0);
    CHECK(unexplained == 0);
    CHECK(amid_save > 10);  // of 100
    MESSAGE(saves, " saves came to their end; ", amid_save, " of 100 kills were amid one, ", behind,
            " after one with later steps");
    for (const fs::directory_entry& entry : fs::directory_iterator(folder.path))
        CHECK_FALSE(contains(entry.path().filename().string(), ".old"));
}

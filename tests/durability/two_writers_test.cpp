// Two processes on one project, in every order of opening, working, saving, closing and being killed, the other one
// stopped meanwhile: one writes at a time, the other is refused at opening, all acknowledged work is there in the end,
// both can always be closed, and nothing is left. The same whatever locks of the system do.

#include <cstdlib>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tests/durability/desk.h"
#include "tests/durability/writer_process.h"
#include "tests/support/slow.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

/// All ways to shuffle two sequences that keep the order of each; false: the first one's turn.
std::vector<std::vector<bool>> shuffles(size_t first, size_t second)
{
    if (first + second == 0) return {{}};
    std::vector<std::vector<bool>> all;
    for (const bool turn : {false, true}) {
        if ((turn ? second : first) == 0) continue;
        for (std::vector<bool> rest : shuffles(first - !turn, second - turn)) {
            rest.insert(rest.begin(), turn);
            all.push_back(std::move(rest));
        }
    }
    return all;
}

struct Outcome {
    size_t orders = 0, taken = 0, failed = 0, wrong = 0;
    std::string first;  ///< the first order that went wrong
};

void try_order(const std::array<std::string, 2>& plans, const std::vector<bool>& turns, bool has_lock_file,
               Outcome& outcome)
{
    const TemporaryFolder folder;
    const WorkFiles files = files_in(folder.path);
    if (!has_lock_file) fs::create_directory(lock_path(files.journal));
    std::array<int64_t, 2> done{};
    std::string order;
    size_t failed = 0, wrong = 0;
    {
        WriterProcess a(files, {.group = 1}), b(files, {.group = 2});
        std::array<size_t, 2> next{};
        std::array<bool, 2> writes{};
        for (const bool who : turns) {
            const char what = plans[who][next[who]++];
            order += sentence(who ? 'B' : 'A', what, ' ');
            const WriterProcess& other = who ? a : b;
            other.stop();
            const char answer = (who ? b : a).tell(what);
            other.go_on();
            outcome.taken += answer == TAKEN;
            failed += answer == FAILED || answer == TOLD;
            if (what == OPEN) {
                writes[who] = answer == DONE;
                wrong += (answer == TAKEN) != writes[!who];
            }
            // The writer is refused nothing, and a process that may not write is refused everything.
            if (what == WORK || what == SAVE) wrong += (answer == TAKEN) == writes[who];
            if (what == WORK) done[who] += answer == DONE;
            if (what == CLOSE || what == KILL) writes[who] = false;
        }
    }
    std::string said;
    auto work = open_work(files, said);
    for (const size_t who : {0u, 1u}) wrong += work->document().mask.voxels_by_group()[who + 1] != done[who];
    wrong += !work->disputes().empty();
    wrong += !work->undo() && done[0] + done[1] > 0;
    work.reset();
    for (const fs::directory_entry& entry : fs::directory_iterator(folder.path)) {
        const std::string name = entry.path().filename().string();
        const bool is_expected = name == "a.journal" || name.starts_with("a.mask") || entry.is_directory();
        if (!is_expected) order += name + ' ';
        wrong += !is_expected;
    }
    ++outcome.orders;
    outcome.failed += failed;
    outcome.wrong += wrong > 0;
    if (failed + wrong > 0 && outcome.first.empty()) outcome.first = order + said;
}

/// Every `step`th order.
Outcome try_all(size_t step, bool has_lock_file = true)
{
    Outcome outcome;
    size_t number = 0;
    const std::array<std::string, 4> plans{"owsc", "owc", "owk", "owsk"};
    for (const std::string& first : plans)
        for (const std::string& second : plans)
            for (const std::vector<bool>& turns : shuffles(first.size(), second.size()))
                if (number++ % step == 0) try_order({first, second}, turns, has_lock_file, outcome);
    CHECK(number == 640);
    return outcome;
}

void check(const Outcome& outcome)
{
    CAPTURE(outcome.first);
    CHECK(outcome.wrong == 0);
    CHECK(outcome.failed == 0);
    CHECK(outcome.taken > outcome.orders);
}

}  // namespace

TEST_CASE("two processes in every order: one writes, the other is told at opening, nothing is lost, and both close")
{
    check(try_all(repeats(2, 1)));
}

TEST_CASE("the same where no lock file can be made, and where locks fail or succeed without excluding")
{
    REQUIRE(locks_can_fail());
    check(try_all(repeats(13, 1), false));
    for (const char* locks : {"ENOSYS", "ENOLCK", "ENOTSUP", "hollow"}) {
        CAPTURE(locks);
        ::setenv("SHVR_LOCKS", locks, 1);
        check(try_all(repeats(13, 1)));
        ::unsetenv("SHVR_LOCKS");
    }
}

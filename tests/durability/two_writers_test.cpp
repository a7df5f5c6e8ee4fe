// Two processes on one project, in every order of opening, working, saving, closing and being killed: one writes at a
// time, the other is warned at opening, all acknowledged work is there in the end, and both can always be closed.

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tests/durability/desk.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

/// Orders to a process, and its answers.
constexpr char OPEN = 'o', WORK = 'w', SAVE = 's', CLOSE = 'c', KILL = 'k';
constexpr char DONE = 'd', TAKEN = 't', FAILED = 'f';

/// Paints the next voxel of its group.
void paint(Work& work, uint8_t group)
{
    const auto at = uint16_t(100 * group + work.document().mask.voxels_by_group()[group]);
    work.perform({"dab", {MaskBrickChange{.brick = 0, .runs = {{at, at, 0, group}}}}});
    work.flush();
}

/// One that is refused looks, as the window does.
char obey(char what, std::unique_ptr<Work>& work, const WorkFiles& files, uint8_t group)
{
    try {
        if (what == OPEN) {
            std::string said;
            try {
                work = open_work(files, said);
            } catch (const JournalTaken&) {
                work = open_work(files, said, {.only_look = true});
                return TAKEN;
            }
        }
        if (what == WORK) paint(*work, group);
        if (what == SAVE) work->save();
        if (what == CLOSE) {
            if (!work->is_kept()) return FAILED;
            work.reset();
        }
        return DONE;
    } catch (const JournalTaken&) {
        return TAKEN;
    } catch (const Error&) {
        return FAILED;
    }
}

class Process {
public:
    Process(const WorkFiles& files, uint8_t group)
    {
        REQUIRE(::pipe(orders_.data()) == 0);
        REQUIRE(::pipe(answers_.data()) == 0);
        child_ = ::fork();
        REQUIRE(child_ >= 0);
        if (child_ > 0) return;
        ::close(orders_[1]);
        std::unique_ptr<Work> work;
        char what = 0;
        while (::read(orders_[0], &what, 1) == 1) {
            const char answer = obey(what, work, files, group);
            if (::write(answers_[1], &answer, 1) != 1) break;
        }
        ::_exit(0);
    }
    Process(const Process&) = delete;
    ~Process()
    {
        for (const int end : orders_) ::close(end);
        if (child_ > 0) ::waitpid(child_, nullptr, 0);
        for (const int end : answers_) ::close(end);
    }

    char tell(char what)
    {
        if (what == KILL) {
            ::kill(child_, SIGKILL);
            ::waitpid(child_, nullptr, 0);
            child_ = 0;
            return DONE;
        }
        char answer = 0;
        REQUIRE(::write(orders_[1], &what, 1) == 1);
        REQUIRE(::read(answers_[0], &answer, 1) == 1);
        return answer;
    }

private:
    std::array<int, 2> orders_{}, answers_{};
    pid_t child_ = 0;
};

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

void try_order(const std::array<std::string, 2>& plans, const std::vector<bool>& turns, bool locks, Outcome& outcome)
{
    const TemporaryFolder folder;
    const WorkFiles files = files_in(folder.path);
    if (!locks) fs::create_directory(lock_path(files.journal));
    std::array<int64_t, 2> done{};
    std::string order;
    size_t failed = 0, wrong = 0;
    {
        Process a(files, 1), b(files, 2);
        std::array<size_t, 2> next{};
        std::array<bool, 2> writes{};
        for (const bool who : turns) {
            const char what = plans[who][next[who]++];
            order += sentence(who ? 'B' : 'A', what, ' ');
            const char answer = (who ? b : a).tell(what);
            outcome.taken += answer == TAKEN;
            failed += answer == FAILED;
            if (what == OPEN) {
                writes[who] = answer == DONE;
                wrong += locks && (answer == TAKEN) != writes[!who];
            }
            // The writer is refused nothing, and a process that may not write is refused everything.
            if (locks && (what == WORK || what == SAVE)) wrong += (answer == TAKEN) == writes[who];
            if (what == WORK) done[who] += answer == DONE;
            if (what == CLOSE || what == KILL) writes[who] = false;
        }
    }
    std::string said;
    const auto work = open_work(files, said);
    for (const size_t who : {0u, 1u}) wrong += work->document().mask.voxels_by_group()[who + 1] != done[who];
    wrong += !work->disputes().empty();
    wrong += !work->undo() && done[0] + done[1] > 0;
    ++outcome.orders;
    outcome.failed += failed;
    outcome.wrong += wrong > 0;
    if (failed + wrong > 0 && outcome.first.empty()) outcome.first = order + said;
}

Outcome try_all(bool locks)
{
    Outcome outcome;
    const std::array<std::string, 4> plans{"owsc", "owc", "owk", "owsk"};
    for (const std::string& first : plans)
        for (const std::string& second : plans)
            for (const std::vector<bool>& turns : shuffles(first.size(), second.size()))
                try_order({first, second}, turns, locks, outcome);
    return outcome;
}

}  // namespace

TEST_CASE("two processes in every order: one writes, the other is told at opening, nothing is lost, and both close")
{
    const Outcome outcome = try_all(true);
    CAPTURE(outcome.first);
    CHECK(outcome.orders == 640);
    CHECK(outcome.wrong == 0);
    CHECK(outcome.failed == 0);
    CHECK(outcome.taken > 640);
}

TEST_CASE("where no lock can be kept the journal itself has one writer, in every order")
{
    const Outcome outcome = try_all(false);
    CAPTURE(outcome.first);
    CHECK(outcome.orders == 640);
    CHECK(outcome.wrong == 0);
    CHECK(outcome.failed == 0);
    CHECK(outcome.taken > 0);
}

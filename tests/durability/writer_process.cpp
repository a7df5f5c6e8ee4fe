#include "tests/durability/writer_process.h"

#include <dlfcn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include <doctest/doctest.h>

#include "tests/durability/desk.h"
#include "tests/durability/watched_calls.h"
#include "tests/support/volume_files.h"

namespace shvr::test {

namespace {

/// Past watched_calls.h, whose lock a paused thread holds.
bool put(int pipe, char what)
{
    return ::syscall(SYS_write, pipe, &what, 1) == 1;
}

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
                work = open_work(files, said, {.belief = Belief::journal});
            } catch (const JournalTaken&) {
                work = open_work(files, said, {.only_look = true});
                return TAKEN;
            }
            if (contains(said, "expected ")) return TOLD;
        }
        if (what == WORK) paint(*work, group);
        if (what == SAVE && !work->save().notices.empty()) return TOLD;
        if (what == CLOSE) {
            if (!work->is_kept()) return FAILED;
            work.reset();
        }
        return DONE;
    } catch (const JournalTaken&) {
        return TAKEN;
    } catch (const std::exception&) {
        return FAILED;
    }
}

}  // namespace

WriterProcess::WriterProcess(const WorkFiles& files, const Options& options)
{
    REQUIRE(::pipe(orders_.data()) == 0);
    REQUIRE(::pipe(answers_.data()) == 0);
    child_ = ::fork();
    REQUIRE(child_ >= 0);
    if (child_ > 0) return;
    ::close(orders_[1]);
    if (!options.host.empty()) ::setenv("SHVR_HOST", options.host.c_str(), 1);
    // The pipes are no files below the folder, so these calls do not pause.
    if (options.pauses)
        refuse_calls(files.journal.parent_path(), [this, replaces = options.renames_replace](const FileCall& call) {
            if (replaces && call.kind == FileCall::Kind::rename && call.at == RENAME_NOREPLACE) return EINVAL;
            char go = 0;
            if (!put(answers_[1], PAUSED) || ::read(orders_[0], &go, 1) != 1) ::_exit(1);
            return 0;
        });
    std::unique_ptr<Work> work;
    char what = 0;
    while (::read(orders_[0], &what, 1) == 1) {
        if (!put(answers_[1], obey(what, work, files, options.group))) break;
    }
    ::_exit(0);
}

WriterProcess::~WriterProcess()
{
    if (child_ > 0) go_on();
    for (const int end : orders_) ::close(end);
    if (child_ > 0) ::waitpid(child_, nullptr, 0);
    for (const int end : answers_) ::close(end);
}

void WriterProcess::order(char what)
{
    REQUIRE(put(orders_[1], what));
}

char WriterProcess::answer()
{
    char said = 0;
    REQUIRE(::read(answers_[0], &said, 1) == 1);
    return said;
}

char WriterProcess::tell(char what)
{
    if (what == KILL) {
        kill();
        return DONE;
    }
    order(what);
    return answer();
}

void WriterProcess::kill()
{
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
    child_ = 0;
}

void WriterProcess::stop() const
{
    if (child_ == 0) return;
    ::kill(child_, SIGSTOP);
    ::waitpid(child_, nullptr, WUNTRACED);
}

void WriterProcess::go_on() const
{
    if (child_ > 0) ::kill(child_, SIGCONT);
}

bool locks_can_fail()
{
    return ::dlsym(RTLD_DEFAULT, "shvr_locks_can_fail") != nullptr;
}

}  // namespace shvr::test

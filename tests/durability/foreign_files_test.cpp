// Files that another program wrote while the work was open, and a save that keeps them: ended before each of its calls,
// or with one call refused. Each file is always there under its own name, and nothing of the other program is lost.

#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <fstream>

#include <doctest/doctest.h>

#include "tests/durability/desk.h"
#include "tests/durability/watched_calls.h"
#include "tests/support/slow.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

constexpr const char* THEIRS = "of somebody else";

struct Kind {
    bool is_sparse = false;    ///< mask and offsets are folders
    bool is_supported = true;  ///< the file system exchanges names, and has links
};

/// What every case begins with: saved work, and its files.
WorkFiles files_of(const Kind& kind, const fs::path& folder)
{
    return kind.is_sparse ? sparse_files_in(folder) : files_in(folder);
}

std::unique_ptr<Work> work_in(const WorkFiles& files)
{
    std::string said;
    std::mt19937 random(5);
    auto work = open_work(files, said);
    for (int i = 0; i < 40; ++i) random_step(*work, random);
    save(*work);
    for (int i = 0; i < 20; ++i) random_step(*work, random);
    work->flush();
    return work;
}

/// Another program puts its own in the place of each file.
void write_theirs(const WorkFiles& files)
{
    for (const Part part : PARTS) {
        const fs::path& file = file_of(files, part);
        const bool is_folder = fs::is_directory(file);
        REQUIRE(fs::exists(file));
        fs::remove_all(file);
        if (is_folder) fs::create_directory(file);
        std::ofstream(is_folder ? file / "notes" : file) << THEIRS;
    }
}

bool is_theirs(const fs::path& path)
{
    const fs::path file = fs::is_directory(path) ? path / "notes" : path;
    return fs::is_regular_file(file) && bytes_of_file(file) == THEIRS;
}

/// The number of other names under which the other program's file is kept.
int kept(const fs::path& file)
{
    int count = 0;
    for (const fs::directory_entry& entry : fs::directory_iterator(file.parent_path()))
        count +=
            entry.path().filename().string().starts_with(file.filename().string() + ".old") && is_theirs(entry.path());
    return count;
}

int errno_for(const Kind& kind, const FileCall& call)
{
    const bool is_optional = call.kind == FileCall::Kind::exchange || call.kind == FileCall::Kind::link;
    return is_optional && !kind.is_supported ? EPERM : 0;
}

/// Every file is there, either theirs or ours; if it is ours, theirs has another name. Returns how many are ours.
int check_files(const WorkFiles& files)
{
    int ours = 0;
    for (const Part part : PARTS) {
        const fs::path& file = file_of(files, part);
        CAPTURE(file);
        CHECK(fs::exists(file));
        if (is_theirs(file)) continue;
        ++ours;
        CHECK(kept(file) > 0);
    }
    return ours;
}

constexpr Kind KINDS[] = {{false, true}, {false, false}, {true, true}, {true, false}};

}  // namespace

// Kind (annotation files): another program's file, and a save that is killed at any call while it replaces that.
TEST_CASE("another program's file has its own name until a save replaces it, wherever the save is killed")
{
    const TemporaryFolder folder;
    for (const Kind& kind : KINDS) {
        CAPTURE(kind.is_sparse);
        CAPTURE(kind.is_supported);
        int theirs = 0, ours = 0;
        bool was_killed = true;
        for (int nth = 0; was_killed; nth += repeats(4, 1)) {
            CAPTURE(nth);
            REQUIRE(nth < 1000);
            const fs::path desk = folder.path / "desk";
            fs::remove_all(desk);
            fs::create_directory(desk);
            const WorkFiles files = files_of(kind, desk);
            const pid_t child = ::fork();
            REQUIRE(child >= 0);
            if (child == 0) {
                const auto work = work_in(files);
                write_theirs(files);
                int calls = 0;
                refuse_calls(desk, [&](const FileCall& call) {
                    if (calls++ == nth) ::kill(::getpid(), SIGKILL);
                    return errno_for(kind, call);
                });
                save(*work);
                ::_exit(0);
            }
            int status = 0;
            REQUIRE(::waitpid(child, &status, 0) == child);
            was_killed = WIFSIGNALED(status);
            CHECK((was_killed || WEXITSTATUS(status) == 0));
            const int count = check_files(files);
            ours += count;
            theirs += int(PARTS.size()) - count;
        }
        CHECK(theirs > 10);
        CHECK(ours > 10);
    }
}

TEST_CASE("another program's file stays when a call of the save fails, and the next save keeps it once")
{
    const TemporaryFolder folder;
    int refused_saves = 0;
    for (const Kind& kind : KINDS) {
        CAPTURE(kind.is_sparse);
        CAPTURE(kind.is_supported);
        bool was_refused = true;
        for (int nth = 0; was_refused; nth += repeats(6, 1)) {
            CAPTURE(nth);
            REQUIRE(nth < 1000);
            const fs::path desk = folder.path / "desk";
            fs::remove_all(desk);
            fs::create_directory(desk);
            const WorkFiles files = files_of(kind, desk);
            const auto work = work_in(files);
            write_theirs(files);
            int calls = 0;
            refuse_calls(desk, [&](const FileCall& call) { return calls++ == nth ? EIO : errno_for(kind, call); });
            const std::string refusal = error_of([&] { save(*work); });
            was_refused = calls > nth;
            refuse_calls(desk, [&](const FileCall& call) { return errno_for(kind, call); });
            if (!refusal.empty()) {
                ++refused_saves;
                check_files(files);
                save(*work);
            }
            refuse_calls(desk, {});
            for (const Part part : PARTS) {
                const fs::path& file = file_of(files, part);
                CAPTURE(file);
                CHECK_FALSE(is_theirs(file));
                // Where names cannot be exchanged, a copy may be left from the save that failed.
                CHECK((kind.is_supported ? kept(file) == 1 : kept(file) >= 1));
            }
        }
    }
    CHECK(refused_saves > 20);
}

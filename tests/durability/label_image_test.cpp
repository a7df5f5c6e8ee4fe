// Ends the program at every call of a save whose mask and offsets are OME-Zarr, where names can be exchanged and where
// they cannot: mask and offsets are those of the last save or of this one, as a whole, and the work goes on.

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

/// A folder with a save, and steps after it.
struct Desk {
    fs::path folder;
    uint64_t saved_mask, saved_field, mask, field, document;
};

Desk make_desk(const fs::path& folder)
{
    fs::create_directory(folder);
    std::string said;
    std::mt19937 random(11);
    const auto work = open_work(sparse_files_in(folder), said);
    const auto paint = [&] {
        for (int i = 0; i < 10; ++i) work->perform(random_painting(work->document(), random));
    };
    paint();
    save(*work);
    Desk desk{folder, hash_of(work->document().mask), hash_of(work->document().density), 0, 0, 0};
    paint();
    work->flush();
    desk.mask = hash_of(work->document().mask);
    desk.field = hash_of(work->document().density);
    desk.document = hash_of(work->document());
    return desk;
}

/// Ends the process before its nth change of files; exchanges of names fail where they are not supported.
[[noreturn]] void save_until_killed(const fs::path& folder, int nth, bool exchanges)
{
    std::string said;
    const auto work = open_work(sparse_files_in(folder), said);
    int calls = 0;
    refuse_calls(folder, [&](const FileCall& call) {
        if (calls++ == nth) ::kill(::getpid(), SIGKILL);
        return call.kind == FileCall::Kind::exchange && !exchanges ? EINVAL : 0;
    });
    save(*work);
    ::_exit(0);
}

/// Checks a folder in which a save was cut off.
void check_folder(const Desk& desk, const fs::path& folder)
{
    std::string said;
    WorkFiles alone = sparse_files_in(folder);
    alone.journal.clear();
    {
        const auto files = open_work(alone, said);
        const uint64_t mask = hash_of(files->document().mask), field = hash_of(files->document().density);
        CHECK((mask == desk.saved_mask || mask == desk.mask));
        CHECK((field == desk.saved_field || field == desk.field));
    }
    const auto work = open_work(sparse_files_in(folder), said);
    CHECK(work->disputes().empty());
    CHECK_FALSE(contains(said, "was changed"));
    CHECK_FALSE(contains(said, "is missing"));
    CHECK(hash_of(work->document()) == desk.document);
    save(*work);
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        CHECK_FALSE(contains(entry.path().filename().string(), ".shvr-part"));
        CHECK_FALSE(contains(entry.path().filename().string(), ".old"));
    }
    CHECK(open_work(alone, said)->document().mask.voxels_by_group() == work->document().mask.voxels_by_group());
}

}  // namespace

TEST_CASE("a save into OME-Zarr that is killed at any call leaves the old or the new mask and offsets, readable")
{
    const TemporaryFolder folder;
    const Desk desk = make_desk(folder.path / "desk");
    REQUIRE(desk.saved_mask != desk.mask);
    REQUIRE(desk.saved_field != desk.field);
    for (const bool exchanges : {true, false}) {
        CAPTURE(exchanges);
        const int step = repeats(6, 1);
        int nth = exchanges ? 0 : 3;
        for (bool was_killed = true; was_killed; nth += step) {
            CAPTURE(nth);
            REQUIRE(nth < 1000);
            const fs::path copy = folder.path / "copy";
            fs::remove_all(copy);
            fs::copy(desk.folder, copy, fs::copy_options::recursive);
            const pid_t child = ::fork();
            REQUIRE(child >= 0);
            if (child == 0) save_until_killed(copy, nth, exchanges);
            int status = 0;
            REQUIRE(::waitpid(child, &status, 0) == child);
            was_killed = WIFSIGNALED(status);
            check_folder(desk, copy);
        }
        CHECK(nth > 40);
    }
}

// Kind (annotation files): a save killed at any call while it replaces a folder with an array of another program.
TEST_CASE("an array that another program added is there after a save that was killed at any call, in old or new folder")
{
    const TemporaryFolder folder;
    const Desk desk = make_desk(folder.path / "desk");
    const std::string content(100, 's');
    const fs::path mask = sparse_files_in(desk.folder).mask, field = sparse_files_in(desk.folder).density;
    for (const fs::path& image : {mask, field}) {
        fs::create_directory(image / "scores");
        std::ofstream(image / "scores" / "0") << content;
    }
    for (const bool exchanges : {true, false}) {
        CAPTURE(exchanges);
        int nth = exchanges ? 0 : 3;
        for (bool was_killed = true; was_killed; nth += repeats(7, 1)) {
            CAPTURE(nth);
            REQUIRE(nth < 1000);
            const fs::path copy = folder.path / "copy";
            fs::remove_all(copy);
            fs::copy(desk.folder, copy, fs::copy_options::recursive);
            const pid_t child = ::fork();
            REQUIRE(child >= 0);
            if (child == 0) save_until_killed(copy, nth, exchanges);
            int status = 0;
            REQUIRE(::waitpid(child, &status, 0) == child);
            was_killed = WIFSIGNALED(status);
            std::string said;
            save(*open_work(sparse_files_in(copy), said));
            CHECK(open_work(sparse_files_in(copy), said)->disputes().empty());
            for (const fs::path& image : {mask, field}) {
                const std::string name = image.filename().string();
                size_t kept = 0;
                for (const fs::directory_entry& entry : fs::directory_iterator(copy))
                    kept += entry.path().filename().string().starts_with(name + ".old") &&
                            bytes_of_file(entry.path() / "scores" / "0") == content;
                // Killed after the copy, the next save makes another one.
                CHECK((exchanges ? kept == 1 : kept >= 1));
                CHECK_FALSE(fs::exists(copy / name / "scores"));
            }
        }
        CHECK(nth > 40);
    }
}

// Kind (annotation files): saves that are interrupted again and again, the first one after it has replaced the mask.
TEST_CASE("a mask is that of its save, however many saves were interrupted since")
{
    const TemporaryFolder folder;
    const Desk desk = make_desk(folder.path / "desk");
    for (int round = 0; round < 15; ++round) {
        const pid_t child = ::fork();
        REQUIRE(child >= 0);
        if (child == 0) {
            std::string said;
            const auto work = open_work(sparse_files_in(desk.folder), said);
            std::mt19937 random(uint32_t(100 + round));
            work->perform(random_painting(work->document(), random));
            refuse_calls(desk.folder, [&, exchanges = 0](const FileCall& call) mutable {
                const bool is_new = call.kind == FileCall::Kind::make_folder;
                if (round == 0 ? exchanges == 2 : is_new) ::kill(::getpid(), SIGKILL);
                exchanges += call.kind == FileCall::Kind::exchange;  // the first one is a trial
                return 0;
            });
            save(*work);
            ::_exit(0);
        }
        int status = 0;
        REQUIRE(::waitpid(child, &status, 0) == child);
        CHECK(WIFSIGNALED(status));
        std::string said;
        const auto work = open_work(sparse_files_in(desk.folder), said);
        CHECK_FALSE(contains(said, "was changed"));
        CHECK(work->disputes().empty());
    }
}

TEST_CASE("where names cannot be exchanged, saves go on: new arrays come under a name that the metadata then tell")
{
    const TemporaryFolder folder;
    const Desk desk = make_desk(folder.path / "desk");
    std::string said;
    const auto work = open_work(sparse_files_in(desk.folder), said);
    refuse_calls(desk.folder, [](const FileCall& call) { return call.kind == FileCall::Kind::exchange ? EINVAL : 0; });
    for (const char* const version : {"v1", "v2", "v1"}) {
        save(*work);
        const fs::path mask = sparse_files_in(desk.folder).mask;
        CHECK(contains(bytes_of_file(mask / ".zattrs"), sentence("\"path\": \"", version, "/0\"")));
        size_t folders = 0;
        for (const fs::directory_entry& entry : fs::directory_iterator(mask)) folders += entry.is_directory();
        CHECK(folders == 1);
    }
    refuse_calls(desk.folder, {});
    WorkFiles alone = sparse_files_in(desk.folder);
    alone.journal.clear();
    const auto files = open_work(alone, said);
    CHECK(hash_of(files->document().mask) == desk.mask);
    CHECK(hash_of(files->document().density) == desk.field);
    // Where exchanges work again, arrays have their usual names.
    save(*work);
    CHECK(contains(bytes_of_file(alone.mask / ".zattrs"), "\"path\": \"0\""));
}

TEST_CASE(
    "every call of a save into OME-Zarr fails once: the old or the new files are whole, and a second try succeeds")
{
    const TemporaryFolder folder;
    const Desk desk = make_desk(folder.path / "desk");
    int refused_saves = 0;
    for (int nth = 0; nth < 1000; nth += repeats(5, 1)) {
        CAPTURE(nth);
        const fs::path copy = folder.path / "copy";
        fs::remove_all(copy);
        fs::copy(desk.folder, copy, fs::copy_options::recursive);
        std::string said;
        auto work = open_work(sparse_files_in(copy), said);
        int calls = 0;
        refuse_calls(copy, [&](const FileCall&) { return calls++ == nth ? ENOSPC : 0; });
        const std::string refused = error_of([&] { save(*work); });
        refuse_calls(copy, {});
        refused_saves += !refused.empty();
        if (!refused.empty()) CHECK(contains(refused, copy.string()));
        work.reset();
        check_folder(desk, copy);
        if (calls <= nth) break;
    }
    CHECK(refused_saves > 5);
}

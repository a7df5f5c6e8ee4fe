// Going on under other names: each call refused once, the power cut anywhere, the program killed anywhere. The work
// before is whole at any moment, and the new one where its session names it.

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <set>
#include <thread>

#include <doctest/doctest.h>

#include "engine/base/atomic_file.h"
#include "tests/durability/desk.h"
#include "tests/durability/power_cut.h"
#include "tests/durability/watched_calls.h"
#include "tests/support/slow.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

WorkFiles named(const fs::path& folder, const std::string& name)
{
    WorkFiles files = files_in(folder);
    files.journal = folder / (name + ".journal");
    files.mask = folder / (name + ".mask");
    files.trace = folder / (name + ".graphml");
    files.density = folder / (name + ".offset");
    return files;
}

/// Its session's file, too, as a caller writes it.
void save_as(Work& work, const fs::path& folder, const std::string& name)
{
    const std::string text = "session of " + name;
    const fs::path session = folder / (name + ".json");
    work.save_as(named(folder, name), {}, session,
                 [&] { write_file_atomically(session, std::as_bytes(std::span(text))); });
}

std::map<std::string, std::string> files_of(const fs::path& folder)
{
    std::map<std::string, std::string> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
        files[entry.path().filename().string()] = bytes_of_file(entry.path());
    return files;
}

struct State {
    uint64_t hash = 0;
    size_t undoable = 0, redoable = 0;
    SettingValues kept;
    bool operator==(const State&) const = default;
};
State state_of(const Work& work)
{
    return {hash_of(work.document()), work.history().undoable(), work.history().redoable(), work.kept_settings()};
}

std::unique_ptr<Work> some_work(const WorkFiles& files, int steps, uint32_t seed)
{
    std::string said;
    std::mt19937 random(seed);
    auto work = open_work(files, said);
    for (int i = 0; i < steps; ++i) random_step(*work, random);
    save(*work);
    for (int i = 0; i < steps; ++i) random_step(*work, random);
    work->flush();
    return work;
}

}  // namespace

TEST_CASE("every call of saving under other names fails once: nothing of it is left, and the work is as it was")
{
    const TemporaryFolder folder;
    int max_calls = 0, refused_saves = 0;
    using Kind = FileCall::Kind;
    for (const int error : {ENOSPC, EIO, EROFS, EINTR, SHORT_WRITE}) {
        const auto can_happen = [&](Kind kind) {
            if (kind == Kind::unlink) return false;  // only removes files after a failed call
            if (error == EINTR) return kind == Kind::write || kind == Kind::sync || kind == Kind::sync_folder;
            return error != SHORT_WRITE || kind == Kind::write;
        };
        for (int nth = 0; nth < 1000; ++nth) {
            CAPTURE(error);
            CAPTURE(nth);
            const fs::path desk = folder.path / "desk";
            fs::remove_all(desk);
            fs::create_directory(desk);
            auto work = some_work(named(desk, "a"), 12, 3);
            const auto before = files_of(desk);
            const State state = state_of(*work);
            int calls = 0;
            refuse_calls(desk,
                         [&](const FileCall& call) { return can_happen(call.kind) && calls++ == nth ? error : 0; });
            const std::string refused = error_of([&] { save_as(*work, desk, "b"); });
            refuse_calls(desk, {});
            REQUIRE((state_of(*work) == state));
            if (!refused.empty()) {
                ++refused_saves;
                CHECK(contains(refused, desk.string()));
                CHECK((files_of(desk) == before));
                if (error == EINTR || error == SHORT_WRITE) CHECK(refused.empty());
                // The work goes on where it was, and a second try succeeds.
                std::mt19937 random(8);
                for (int i = 0; i < 3; ++i) random_step(*work, random);
                const State gone_on = state_of(*work);
                save_as(*work, desk, "b");
                CHECK((state_of(*work) == gone_on));
            }
            const State last = state_of(*work);
            work.reset();
            std::string said;
            CHECK((state_of(*open_work(named(desk, "b"), said)) == last));
            CHECK(said.empty());
            if (refused.empty()) CHECK((state_of(*open_work(named(desk, "a"), said)) == state));
            max_calls = std::max(max_calls, calls);
            if (calls <= nth) break;
        }
    }
    CHECK(max_calls > 15);
    CHECK(refused_saves > 40);
    MESSAGE("at most ", max_calls, " calls; ", refused_saves, " refused in words");
}

TEST_CASE("power cuts while work goes on under other names leave the work before, and the new one where it is")
{
    const TemporaryFolder folder;
    const fs::path desk = folder.path / "desk", cut_desk = folder.path / "cut";
    fs::create_directory(desk);
    watch(desk);
    auto work = some_work(named(desk, "a"), 15, 4);
    note(1);  // from here on the old work is as it stays
    const State old = state_of(*work);
    std::vector<State> states{old};
    save_as(*work, desk, "b");
    note(2);
    std::mt19937 random(5);
    for (int i = 0; i < 15; ++i) {
        random_step(*work, random);
        states.push_back(state_of(*work));
    }
    save(*work);
    work.reset();
    note(3);
    const std::vector<FileCall> calls = stop_watching();
    size_t begun = 0;
    while (calls[begun].kind != FileCall::Kind::note) ++begun;
    std::string first;
    size_t faults = 0, with_new = 0;
    const auto fail_at = [&](size_t at, const std::string& why) {
        if (faults++ == 0) first = sentence("after ", at, " calls: ", why);
    };
    const int cuts = repeats(200, 1000);
    for (int i = 0; i < cuts; ++i) {
        const PowerCut cut{.calls = begun + 1 + random() % (calls.size() - begun)};
        uint64_t acknowledged = 0;
        for (const FileCall& call : std::span(calls).first(cut.calls))
            if (call.kind == FileCall::Kind::note) acknowledged = call.at;
        fs::remove_all(cut_desk);
        fs::create_directories(cut_desk);
        for (const auto& [path, content] : disk_after(calls, cut, random))
            std::ofstream(cut_desk / fs::path(path).filename(), std::ios::binary) << content;
        try {
            std::string said;
            if (state_of(*open_work(named(cut_desk, "a"), said)) != old) fail_at(cut.calls, "the old work is another");
            const bool is_new = fs::exists(cut_desk / "b.json");
            if (!is_new && acknowledged >= 2) fail_at(cut.calls, "the new work is not there");
            if (!is_new) continue;
            ++with_new;
            const State found = state_of(*open_work(named(cut_desk, "b"), said));
            if (std::ranges::find(states, found) == states.end()) fail_at(cut.calls, "the new work never was so");
            if (acknowledged >= 3 && found != states.back()) fail_at(cut.calls, "of the new work some is lost");
            if (contains(said, "was changed") || contains(said, "is missing")) fail_at(cut.calls, said);
        } catch (const Error& error) {
            fail_at(cut.calls, error.what());
        }
    }
    CAPTURE(first);
    CHECK(faults == 0);
    CHECK(with_new > size_t(cuts / 10));
    CHECK(with_new < size_t(cuts));
    MESSAGE(calls.size(), " calls, ", with_new, " of ", cuts, " cuts with the new work");
}

TEST_CASE("kills while work goes on under other names leave each work whole")
{
    using namespace std::chrono;
    const TemporaryFolder folder;
    std::mt19937 random(6);
    size_t with_new = 0;
    microseconds longest{30000};  // grows to twice what the first new work takes: much, under a sanitizer
    const int rounds = repeats(20, 100);
    for (int round = 0; round < rounds; ++round) {
        const fs::path desk = folder.path / "desk";
        fs::remove_all(desk);
        fs::create_directory(desk);
        State old;
        {
            const auto work = some_work(named(desk, "0"), 10, uint32_t(round));
            old = state_of(*work);
        }
        const pid_t child = ::fork();
        REQUIRE(child >= 0);
        if (child == 0) {
            std::string said;
            auto work = open_work(named(desk, "0"), said);
            for (int name = 1;; ++name) save_as(*work, desk, std::to_string(name));
        }
        const auto begun = steady_clock::now();
        while (round == 0 && !fs::exists(desk / "1.json") && steady_clock::now() < begun + minutes(1))
            std::this_thread::sleep_for(milliseconds(1));
        longest = std::max(longest, 2 * duration_cast<microseconds>(steady_clock::now() - begun));
        std::this_thread::sleep_for(microseconds(random() % uint64_t(longest.count())));
        ::kill(child, SIGKILL);
        int status = 0;
        REQUIRE(::waitpid(child, &status, 0) == child);
        std::string said;
        int name = 0;
        do {
            CAPTURE(round);
            CAPTURE(name);
            CHECK((state_of(*open_work(named(desk, std::to_string(name)), said)) == old));
            CHECK_FALSE(contains(said, "is missing"));
            CHECK_FALSE(contains(said, "was changed"));
            ++name;
        } while (fs::exists(desk / sentence(name, ".json")));
        with_new += name > 1;
    }
    CHECK(with_new > 0);  // how many depends on the machine
    MESSAGE(with_new, " of ", rounds, " kills with new work");
}

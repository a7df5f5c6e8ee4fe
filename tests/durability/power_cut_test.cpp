// Cuts the power at any moment of work and saving: no state is unreadable or mixed, and no acknowledged step is lost.
// The same proof must fail on a disk that ignores syncs.

#include <algorithm>
#include <fstream>
#include <set>

#include <doctest/doctest.h>

#include "tests/durability/desk.h"
#include "tests/durability/power_cut.h"
#include "tests/support/slow.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

/// The calls made, and the states in between.
struct Record {
    fs::path folder;
    WorkFiles (*files_of)(const fs::path& folder) = nullptr;
    std::vector<FileCall> calls;
    struct State {
        size_t steps = 0;
        uint64_t hash = 0;
        SettingValues kept;
        bool operator==(const State&) const = default;
    };
    std::vector<State> states;                 ///< at the beginning, and after each step or change of what is kept
    std::set<uint64_t> masks, traces, fields;  ///< saved ones, and the empty one
};

using FilesOf = WorkFiles (*)(const fs::path& folder);

/// Notes among the calls hold the number of the last state that is acknowledged.
Record work_of_a_day(const fs::path& folder, FilesOf files_of)
{
    Record record;
    record.folder = folder;
    record.files_of = files_of;
    std::mt19937 random(5);
    record.states.push_back({0, hash_of(unannotated()), {}});
    record.masks.insert(hash_of(Mask(ANNOTATED_SIZE)));
    record.traces.insert(hash_of(TraceGraph()));
    record.fields.insert(hash_of(DensityField(ANNOTATED_SIZE, ANNOTATED_TYPE)));
    watch(folder);
    std::string said;
    for (int day = 0; day < 3; ++day) {
        auto work = open_work(files_of(folder), said);
        for (int i = 0; i < 110; ++i) {
            const Record::State before = record.states.back();
            const size_t steps = before.steps + size_t(random_step(*work, random));
            const Record::State now{steps, hash_of(work->document()), work->kept_settings()};
            if (now != before) record.states.push_back(now);
            // The journal begins with the first step.
            if (random() % 6 == 0 && now.steps > 0) {
                work->flush();
                note(record.states.size() - 1);
            }
            if (random() % 20 != 0) continue;
            record.masks.insert(hash_of(work->document().mask));
            record.traces.insert(hash_of(work->document().trace));
            record.fields.insert(hash_of(work->document().density));
            save(*work);
            note(record.states.size() - 1);
        }
        work.reset();
        note(record.states.size() - 1);
    }
    record.calls = stop_watching();
    return record;
}

/// Why a disk breaks the guarantee; empty if it does not.
std::string fault_of(const fs::path& folder, const Disk& disk, const Record& record, size_t acknowledged)
{
    fs::remove_all(folder);
    fs::create_directories(folder);
    for (const auto& [path, content] : disk) {
        const fs::path copy = folder / fs::path(path).lexically_relative(record.folder);
        fs::create_directories(copy.parent_path());
        std::ofstream file(copy, std::ios::binary);
        file.write(content.data(), std::streamsize(content.size()));
    }
    WorkFiles files = record.files_of(folder);
    std::string said;
    try {
        const auto work = open_work(files, said);
        const Record::State found{steps_in(files.journal), hash_of(work->document()), work->kept_settings()};
        const auto state = std::find(record.states.begin(), record.states.end(), found);
        if (state == record.states.end()) return sentence("after ", found.steps, " steps is a state that never was");
        // The same state may have been twice.
        if (std::find(record.states.begin() + ptrdiff_t(acknowledged), record.states.end(), found) ==
            record.states.end())
            return sentence("acknowledged state ", acknowledged, ", found ", state - record.states.begin());
        if ((contains(said, "was changed") || contains(said, "is missing"))) return said;
        // The files without the journal, each as one save left it.
        files.journal.clear();
        const auto saved = open_work(files, said);
        if (!record.masks.contains(hash_of(saved->document().mask))) return "the mask is of no save";
        if (!record.traces.contains(hash_of(saved->document().trace))) return "the trace is of no save";
        if (!record.fields.contains(hash_of(saved->document().density))) return "the offsets are of no save";
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

struct Faults {
    size_t count = 0;
    std::string first;
};

Faults faults_of(const Record& record, const fs::path& folder, size_t cuts, bool syncs_count)
{
    Faults faults;
    std::mt19937 random(17);
    for (size_t i = 0; i < cuts; ++i) {
        // Each of several equal parts of the calls has one cut.
        const size_t begin = i * (record.calls.size() + 1) / cuts, end = (i + 1) * (record.calls.size() + 1) / cuts;
        const size_t calls = begin + random() % std::max<size_t>(1, end - begin);
        const PowerCut cut{.calls = calls, .syncs_count = syncs_count};
        size_t acknowledged = 0;
        for (const FileCall& call : std::span(record.calls).first(cut.calls))
            if (call.kind == FileCall::Kind::note) acknowledged = call.at;
        const std::string fault = fault_of(folder, disk_after(record.calls, cut, random), record, acknowledged);
        if (fault.empty()) continue;
        if (faults.count++ == 0) faults.first = sentence("after ", cut.calls, " calls: ", fault);
    }
    return faults;
}

}  // namespace

TEST_CASE("power cuts at any moment leave what was acknowledged, and nothing mixed")
{
    const TemporaryFolder folder;
    fs::create_directory(folder.path / "desk");
    const Record record = work_of_a_day(folder.path / "desk", files_in);
    REQUIRE(record.states.size() > 100);
    REQUIRE(record.masks.size() > 4);
    const Faults faults = faults_of(record, folder.path / "cut", repeats(300, 2000), true);
    CAPTURE(faults.first);
    CHECK(faults.count == 0);
    MESSAGE(record.calls.size(), " calls, ", record.states.back().steps, " steps, ", record.masks.size() - 1, " saves");

    const size_t cuts = repeats(60, 300);
    const Faults without_syncs = faults_of(record, folder.path / "cut", cuts, false);
    CHECK(without_syncs.count > cuts / 3);
    MESSAGE("without syncs: ", without_syncs.count, " of ", cuts, ", the first ", without_syncs.first);
}

TEST_CASE("power cuts while mask and offsets are OME-Zarr: each is that of one save, as a whole")
{
    const TemporaryFolder folder;
    fs::create_directory(folder.path / "desk");
    const Record record = work_of_a_day(folder.path / "desk", sparse_files_in);
    REQUIRE(record.masks.size() > 4);
    const Faults faults = faults_of(record, folder.path / "cut", repeats(100, 2000), true);
    CAPTURE(faults.first);
    CHECK(faults.count == 0);
    const size_t cuts = repeats(30, 300);
    CHECK(faults_of(record, folder.path / "cut", cuts, false).count > cuts / 3);
}

// Cuts a journal of all kinds of records at every byte: it opens as the work after the last whole record, and work goes
// on from there.

#include <doctest/doctest.h>

#include "tests/durability/desk.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

WorkFiles files_of(const fs::path& folder, const char* name, const SettingValues& kept)
{
    WorkFiles files = files_in(folder);
    files.journal = folder / (std::string(name) + ".journal");
    files.mask = folder / (std::string(name) + ".mask");
    files.trace = folder / (std::string(name) + ".graphml");
    files.density = folder / (std::string(name) + ".offset");
    files.kept = kept;
    return files;
}

struct Left {
    uint64_t hash = 0;
    SettingValues kept;
    size_t undoable = 0, redoable = 0;
    bool operator==(const Left&) const = default;
};

Left left(const Work& work)
{
    return {hash_of(work.document()), work.kept_settings(), work.history().undoable(), work.history().redoable()};
}

/// The state of the work after each number of whole records in its journal. There is none between records that are
/// written together, where kept settings may be those before or after.
std::map<size_t, Left> all_kinds_of_work(const WorkFiles& files)
{
    std::map<size_t, Left> states;
    Work work(ANNOTATED_SIZE, ANNOTATED_TYPE);
    work.set_limits({.steps_between_states = 12});
    work.set_clock([] { return int64_t(0); });  // one note of the time: how many steps are noted depends on no speed
    work.open(files);
    const auto note = [&] {
        work.flush();
        states[scan_journal(files.journal).records.size()] = left(work);
    };
    for (uint16_t i = 0; i < 20; ++i) {
        work.perform({"dab", {MaskBrickChange{.brick = 0, .runs = {{i, i, 0, uint8_t(i + 1)}}}}});
        note();
        work.keep_settings({{"view", sentence("{\"zoom\":", i, "}")}});
        note();
        work.perform({"light", {SettingChange{"light", i == 0 ? "" : sentence(i - 1), sentence(i)}}});
        note();
        if (i % 4 == 1) REQUIRE(work.undo() != nullptr);
        note();
        if (i % 8 == 1) REQUIRE(work.redo() != nullptr);
        note();
        if (i == 3) work.save();  // without the session, whose file stays as it was
        note();
        if (i != 12) continue;
        REQUIRE(work.revert() != nullptr);
        note();
        work.keep_settings({{"probe", "{\"radius\":7}"}, {"view", "{}"}});
        note();
    }
    return states;
}

}  // namespace

TEST_CASE("a journal cut at any byte opens as the work was after its last whole record")
{
    const TemporaryFolder folder;
    const SettingValues kept{{"view", "{}"}, {"probe", "{}"}};
    const WorkFiles files = files_of(folder.path, "whole", kept);
    const std::map<size_t, Left> states = all_kinds_of_work(files);
    const std::string whole = bytes_of_file(files.journal);
    const JournalScan scan = scan_journal(files.journal);
    REQUIRE(std::ranges::count(scan.records, RecordKind::state, &JournalRecord::kind) > 0);  // fewer on slow machines
    REQUIRE(std::ranges::count(scan.records, RecordKind::kept, &JournalRecord::kind) > 20);
    const WorkFiles cut = files_of(folder.path, "cut", kept);
    size_t wrong = 0, compared = 0, lost_notices = 0;
    for (size_t bytes = 0; bytes <= whole.size(); ++bytes) {
        CAPTURE(bytes);
        folder.write("cut.journal", whole.substr(0, bytes));
        const size_t records = scan_journal(cut.journal).records.size();
        Work work(ANNOTATED_SIZE, ANNOTATED_TYPE);
        for (const Notice& notice : work.open(cut, {.only_look = true}))
            lost_notices += contains(notice.text, "cannot be taken") || contains(notice.text, "cannot be read");
        const auto state = states.find(records);
        if (state == states.end()) continue;
        ++compared;
        if (left(work) != state->second) {
            ++wrong;
            CHECK_MESSAGE(hash_of(work.document()) == state->second.hash, records, " records");
            CHECK_MESSAGE((work.kept_settings() == state->second.kept), records, " records");
        }
    }
    CHECK(wrong == 0);
    CHECK(lost_notices == 0);
    CHECK(compared > whole.size() / 2);  // states come in the background: how many, and where, depends on speed
    MESSAGE(whole.size(), " cuts of ", scan.records.size(), " records, ", compared, " after a noted step");
    // Settings kept before the first command belong to no journal.
    const WorkFiles none = files_of(folder.path, "none", kept);
    Work looked(ANNOTATED_SIZE, ANNOTATED_TYPE);
    looked.open(none);
    looked.keep_settings({{"view", "{\"zoom\":2}"}});
    CHECK_FALSE(fs::exists(none.journal));
}

// Going on under other names; tests/durability/save_as_test.cpp shows what it survives.

#include <doctest/doctest.h>

#include "engine/annotation/files/mask_image.h"
#include "engine/annotation/work/work.h"
#include "tests/support/random_annotation.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

WorkFiles named(const fs::path& folder, const char* name)
{
    WorkFiles files = files_in(folder);
    for (fs::path* file : {&files.journal, &files.mask, &files.trace, &files.density})
        *file = folder / (name + file->extension().string());
    return files;
}

std::unique_ptr<Work> opened(const WorkFiles& files, std::string& said)
{
    auto work = std::make_unique<Work>(ANNOTATED_SIZE, ANNOTATED_TYPE);
    said.clear();
    for (const Notice& notice : work->open(files)) said += notice.text + "\n";
    for (const Dispute& dispute : work->disputes()) said += dispute.text + "\n";
    return work;
}

std::map<std::string, std::string> files_of(const fs::path& folder)
{
    std::map<std::string, std::string> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
        files[entry.path().filename().string()] = bytes_of_file(entry.path());
    return files;
}

Command dab(uint16_t at)
{
    return {"dab", {MaskBrickChange{.brick = 0, .runs = {{at, at, 0, 1}}}}};
}

}  // namespace

TEST_CASE("work goes on under other names with its whole history, and what was there before stays as it is")
{
    const TemporaryFolder old, fresh;
    std::string said;
    std::mt19937 random(3);
    auto work = opened(named(old.path, "a"), said);
    for (int i = 0; i < 60; ++i) work->perform(random_command(work->document(), random));
    work->save();
    work->keep_settings({{"view", "top"}});
    for (int i = 0; i < 20; ++i) work->perform(random_command(work->document(), random));
    work->undo();
    const uint64_t hash = hash_of(work->document());
    const size_t undoable = work->history().undoable(), unsaved = work->unsaved();
    bool is_last = false;
    const Work::Saved saved = work->save_as(named(fresh.path, "b"), {}, fresh.path / "b.json",
                                            [&] { is_last = fs::exists(fresh.path / "b.mask"); });
    CHECK(is_last);
    CHECK(saved.files.size() == 3);
    CHECK(work->unsaved() == 0);
    CHECK(work->is_saved());
    CHECK(work->hold()->journal() == fresh.path / "b.journal");
    CHECK_FALSE(holder_of(old.path / "a.journal").has_value());
    CHECK(journal_of_mask(fresh.path / "b.mask")->name == "b.journal");
    const auto before = files_of(old.path);

    work->perform(dab(9999));
    work->keep_settings({{"view", "left"}});
    work->save();
    for (size_t i = 0; i < undoable + 1; ++i) REQUIRE(work->undo() != nullptr);
    CHECK(hash_of(work->document()) == hash_of(unannotated()));
    while (work->redo() != nullptr) continue;
    work->undo();
    CHECK(hash_of(work->document()) == hash);
    CHECK(work->revert() != nullptr);
    work.reset();
    CHECK(files_of(old.path) == before);

    work = opened(named(old.path, "a"), said);
    CHECK(contains(said, sentence("holds ", unsaved, " steps that were not saved")));
    CHECK(hash_of(work->document()) == hash);
    CHECK(work->history().redoable() == 1);
    CHECK(work->kept_settings().at("view") == "top");
    work = opened(named(fresh.path, "b"), said);
    CHECK(work->history().undoable() == undoable + 1);  // the revert
    CHECK(work->kept_settings().at("view") == "left");
    CHECK(!contains(said, "is missing"));
    CHECK(work->disputes().empty());
}

TEST_CASE("without a history the files alone go on, and the new journal begins with the first command")
{
    const TemporaryFolder folder;
    std::string said;
    opened(named(folder.path, "a"), said)->save();
    fs::remove(folder.path / "a.journal");
    auto work = opened(named(folder.path, "a"), said);
    work->save_as(named(folder.path, "b"), {});
    CHECK_FALSE(fs::exists(folder.path / "b.journal"));
    const auto before = files_of(folder.path);
    work->perform(dab(1));
    work->save();
    CHECK(fs::exists(folder.path / "b.journal"));
    CHECK_FALSE(fs::exists(folder.path / "a.journal"));
    work.reset();
    CHECK(bytes_of_file(folder.path / "a.mask") == before.at("a.mask"));
    CHECK(opened(named(folder.path, "b"), said)->document().mask.voxels_by_group()[1] == 1);
}

TEST_CASE("nothing that is there is replaced, and a session that cannot be written leaves nothing")
{
    const TemporaryFolder folder;
    std::string said;
    auto work = opened(named(folder.path, "a"), said);
    work->perform(dab(1));
    work->perform({"offset", {DensityBrickChange{.brick = 0, .runs = {{5, 5, 0, 9}}}}});
    work->save();
    for (const char* name : {"b.json", "b.journal", "b.mask", "b.mask.json", "b.graphml", "b.offset"}) {
        CAPTURE(name);
        folder.write(name, "of somebody");
        const auto before = files_of(folder.path);
        CHECK(contains(error_of([&] { work->save_as(named(folder.path, "b"), {}, folder.path / "b.json", [] {}); }),
                       std::string(name) + ": exists already; expected a name that is free"));
        CHECK(files_of(folder.path) == before);
        fs::remove(folder.path / name);
    }
    const auto before = files_of(folder.path);
    const auto refuse = [] { fail("b.json: cannot be written"); };
    CHECK(contains(error_of([&] { work->save_as(named(folder.path, "b"), {}, folder.path / "b.json", refuse); }),
                   "b.json: cannot be written"));
    CHECK(files_of(folder.path) == before);
    CHECK_FALSE(error_of([&] { work->save_as(named(folder.path / "none", "b"), {}); }).empty());
    WorkFiles nameless = named(folder.path, "b");
    nameless.density.clear();
    CHECK(contains(error_of([&] { work->save_as(nameless, {}); }), "names no file for density offsets"));
    {
        const auto other = opened(named(folder.path, "b"), said);  // holds those names, without a file
        CHECK_THROWS_AS(work->save_as(named(folder.path, "b"), {}), JournalTaken);
    }
    work->perform(dab(2));
    work->save_as(named(folder.path, "b"), {});
    const auto looking = std::make_unique<Work>(ANNOTATED_SIZE, ANNOTATED_TYPE);
    looking->open(named(folder.path, "a"), {.only_look = true});
    CHECK_THROWS_AS(looking->save_as(named(folder.path, "c"), {}), JournalTaken);
}

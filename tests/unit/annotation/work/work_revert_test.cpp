// Going back to what was last saved.

#include <doctest/doctest.h>

#include "engine/annotation/files/mask_file.h"
#include "engine/annotation/work/work.h"
#include "tests/support/random_annotation.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

class Desk : public TemporaryFolder {
public:
    WorkFiles files() const
    {
        WorkFiles files = files_in(path);
        files.settings = in_file;
        return files;
    }
    std::unique_ptr<Work> open(const Work::Opening& opening = {}) const
    {
        auto work = std::make_unique<Work>(ANNOTATED_SIZE, ANNOTATED_TYPE);
        work->open(files(), opening);
        return work;
    }
    void save(Work& work)
    {
        work.save({}, [&] { in_file = work.settings(); });
    }
    SettingValues in_file{{"light", "file"}};
};

Command dab(uint16_t at, uint8_t group = 1)
{
    return {"dab", {MaskBrickChange{.brick = 0, .runs = {{at, at, 0, group}}}}};
}

/// Work of all kinds.
void go_on(Work& work, std::mt19937& random, int steps)
{
    for (int i = 0; i < steps; ++i) work.perform(random_command(work.document(), random));
    work.change_settings("light", {{"light", sentence(random())}});
}

}  // namespace

TEST_CASE("revert goes back to the last save in one step, which undo takes back exactly")
{
    Desk desk;
    std::mt19937 random(2);
    auto work = desk.open();
    go_on(*work, random, 30);
    desk.save(*work);
    const uint64_t saved = hash_of(work->document());
    CHECK(work->revert() == nullptr);
    go_on(*work, random, 30);
    const uint64_t now = hash_of(work->document());
    const size_t steps = work->history().undoable();
    REQUIRE(work->revert() != nullptr);
    CHECK(hash_of(work->document()) == saved);
    CHECK(work->history().undoable() == steps + 1);
    CHECK(work->undo()->label == "reverted to the last save");
    CHECK(hash_of(work->document()) == now);
    work->redo();
    CHECK(hash_of(work->document()) == saved);
    CHECK(work->revert() == nullptr);
    work.reset();
    // The same after opening, whatever has become of the files: the journal knows.
    work = desk.open();
    CHECK(hash_of(work->document()) == saved);
    work->undo();
    work.reset();
    for (const fs::path& file : {desk.files().mask, desk.files().trace, desk.files().density}) fs::remove(file);
    work = desk.open();
    CHECK(hash_of(work->document()) == now);
    REQUIRE(work->revert() != nullptr);
    CHECK(hash_of(work->document()) == saved);
    CHECK(work->settings().at("light") != "file");
}

TEST_CASE("what was never saved is not reverted, and it is said")
{
    const Desk desk;
    {
        const auto work = desk.open();
        CHECK(work->revert() == nullptr);
        CHECK_FALSE(fs::exists(desk.files().journal));
        work->perform(dab(1));
        const std::string refusal = error_of([&] { work->revert(); });
        CHECK(contains(refusal, "a.journal: was never saved; expected a save to go back to; undo takes back"));
        CHECK(work->history().undoable() == 1);
        work->undo();
        CHECK_FALSE(error_of([&] { work->revert(); }).empty());
    }
    // Nor is work that was begun afresh, though there are files.
    desk.open()->save();
    {
        const auto work = desk.open({.start = Work::Start::fresh});
        work->perform(dab(2));
        CHECK(contains(error_of([&] { work->revert(); }), "was never saved"));
    }
    const auto work = desk.open({.only_look = true});
    CHECK_THROWS_AS(work->revert(), JournalTaken);
}

TEST_CASE("work that began with saved files goes back to them")
{
    const Desk desk;
    Mask mask(ANNOTATED_SIZE);
    mask.apply({.brick = 0, .runs = {{10, 19, 0, 7}}}, Direction::forwards);
    save_mask(desk.files().mask, mask);
    const auto work = desk.open();
    work->perform(dab(1));
    work->change_settings("light", {{"light", "other"}});
    REQUIRE(work->revert() != nullptr);
    CHECK(hash_of(work->document().mask) == hash_of(mask));
    CHECK(work->settings().at("light") == "file");
}

TEST_CASE("a file that others changed and that was taken is what is gone back to")
{
    Desk desk;
    std::mt19937 random(3);
    {
        const auto work = desk.open();
        go_on(*work, random, 20);
        desk.save(*work);
    }
    const uint64_t trace = hash_of(desk.open({.only_look = true})->document().trace);
    Mask mask(ANNOTATED_SIZE);
    mask.apply({.brick = 0, .runs = {{10, 19, 0, 7}}}, Direction::forwards);
    save_mask(desk.files().mask, mask);
    {
        const auto work = desk.open();
        REQUIRE(work->disputes().size() == 1);
        CHECK_THROWS_AS(work->revert(), Disputed);
    }
    const auto work = desk.open({.belief = Belief::files});
    go_on(*work, random, 20);
    REQUIRE(work->revert() != nullptr);
    CHECK(hash_of(work->document().mask) == hash_of(mask));
    CHECK(hash_of(work->document().trace) == trace);
}

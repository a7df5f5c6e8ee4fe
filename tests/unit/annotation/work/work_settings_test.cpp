// Settings are work like paint: journalled before they count, undone, and compared with the session's file.

#include <doctest/doctest.h>

#include "engine/annotation/work/work.h"
#include "tests/support/random_annotation.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

const SettingValues GREY{{"light", "{\"ambient\":0.2}"}, {"transfer_function", "\"grey\""}};

/// `values` with one of them replaced.
SettingValues with(SettingValues values, const std::string& name, const std::string& value)
{
    values[name] = value;
    return values;
}

class Desk : public TemporaryFolder {
public:
    /// Reopens the work, as of a session file with these settings.
    std::unique_ptr<Work> open(const SettingValues& in_file) const
    {
        auto work = std::make_unique<Work>(ANNOTATED_SIZE, ANNOTATED_TYPE);
        WorkFiles files = files_in(path);
        files.settings = in_file;
        files.normalized = [](const SettingValues& values) {
            for (const auto& [name, value] : values)
                if (value == "unreadable") fail(name, ": unreadable");
            return values;
        };
        said.clear();
        for (const Notice& notice : work->open(files)) said += notice.text + "\n";
        return work;
    }
    mutable std::string said;
};

const SettingValues RED = with(GREY, "transfer_function", "\"red\"");
const SettingValues DIM = with(RED, "light", "{\"ambient\":0.1}");

}  // namespace

TEST_CASE("a setting is a step: it comes back from the journal, and undo takes back the last thing done")
{
    const Desk desk;
    auto work = desk.open(GREY);
    CHECK(work->settings() == GREY);
    CHECK(work->change_settings("nothing", GREY) == nullptr);
    work->change_settings("red", RED);
    work->perform({"dab", {MaskBrickChange{.brick = 0, .runs = {{7, 7, 0, 1}}}}});
    work->change_settings("dim", DIM);
    CHECK(work->unsaved() == 3);
    work.reset();

    work = desk.open(GREY);
    CHECK(work->settings() == DIM);
    CHECK(contains(desk.said, "holds 3 steps that were not saved; none of them is lost"));
    CHECK(work->undo()->label == "dim");
    CHECK(work->settings() == RED);
    CHECK(work->undo()->label == "dab");
    CHECK(work->settings() == RED);
    CHECK(work->undo()->label == "red");
    CHECK(work->settings() == GREY);
    CHECK(work->undo() == nullptr);
    for (int i = 0; i < 3; ++i) work->redo();
    CHECK(work->settings() == DIM);
}

TEST_CASE("a session's file that was changed since it was saved is taken, as a step that can be undone")
{
    const Desk desk;
    bool is_written = false;
    {
        const auto work = desk.open(GREY);
        work->change_settings("red", RED);
        work->save({}, [&] { is_written = true; });
        work->change_settings("dim", DIM);
    }
    CHECK(is_written);
    CHECK(desk.open(RED)->settings() == DIM);  // the file is as it was saved
    CHECK(!contains(desk.said, "were changed"));

    const SettingValues blue = with(RED, "transfer_function", "\"blue\"");
    auto work = desk.open(blue);
    CHECK(contains(desk.said, "these settings of the session were changed since it was saved: transfer_function;"));
    const SettingValues blue_and_dim = with(DIM, "transfer_function", "\"blue\"");
    CHECK(work->settings() == blue_and_dim);
    SUBCASE("the first step records it")
    {
        const SettingValues bright = with(blue_and_dim, "light", "{\"ambient\":0.9}");
        work->change_settings("bright", bright);
        CHECK(work->settings() == bright);
        CHECK(work->undo()->label == "bright");
        CHECK(work->settings() == blue_and_dim);
        CHECK(work->undo()->label == "settings changed in the session's file");
        CHECK(work->settings() == DIM);
        CHECK(work->undo()->label == "dim");
    }
    SUBCASE("undo takes it back first")
    {
        work->undo();
        CHECK(work->settings() == DIM);
        work.reset();
        CHECK(desk.open(RED)->settings() == DIM);
    }
    SUBCASE("taken once, it is no news, whatever is done afterwards")
    {
        work->undo();
        work->undo();
        work.reset();
        work = desk.open(blue);
        CHECK(!contains(desk.said, "were changed"));
        CHECK(work->settings() == RED);
        CHECK(work->redo()->label == "dim");
        work->change_settings("bright", with(DIM, "transfer_function", "\"bright\""));
        work.reset();
        work = desk.open(blue);
        CHECK(!contains(desk.said, "were changed"));
        CHECK(work->settings().at("transfer_function") == "\"bright\"");
    }
    SUBCASE("redo of what it came after is gone")
    {
        work->undo();
        work->undo();
        work.reset();
        work = desk.open(with(RED, "transfer_function", "\"green\""));
        CHECK(work->redo() == nullptr);
    }
    SUBCASE("a save that writes no session leaves its file as it was known")
    {
        work->save();
        work.reset();
        work = desk.open(blue);
        CHECK(!contains(desk.said, "were changed"));
        CHECK(work->settings() == blue_and_dim);
        work->change_settings("dim", DIM);
        work->save();
        work.reset();
        CHECK(desk.open(blue)->settings() == DIM);
    }
}

TEST_CASE("settings that cannot be read are the file's")
{
    const Desk desk;
    desk.open(GREY)->change_settings("odd", with(GREY, "light", "unreadable"));
    CHECK(desk.open(GREY)->settings() == GREY);
    CHECK(contains(desk.said, "its settings cannot be read: light: unreadable; those of the session's file are taken"));
}

TEST_CASE("a journal from before settings were kept knows none, and takes the file's")
{
    const Desk desk;
    desk.open({})->perform({"dab", {MaskBrickChange{.brick = 0, .runs = {{7, 7, 0, 1}}}}});
    auto work = desk.open(GREY);
    CHECK(work->settings() == GREY);
    CHECK(!contains(desk.said, "were changed"));
    work->change_settings("red", RED);
    work.reset();
    CHECK(desk.open(GREY)->settings() == RED);
}

// A save in the background: it holds the state at its begin, and no step performed since.

#include <doctest/doctest.h>

#include <thread>

#include "engine/annotation/files/mask_file.h"
#include "engine/annotation/work/work.h"
#include "tests/support/random_annotation.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

struct Desk : TemporaryFolder {
    WorkFiles files() const { return files_in(path); }
    std::unique_ptr<Work> open(std::string* said = nullptr) const
    {
        auto work = std::make_unique<Work>(ANNOTATED_SIZE, ANNOTATED_TYPE);
        for (const Notice& notice : work->open(files()))
            if (said) *said += notice.text + "\n";
        for (const Dispute& dispute : work->disputes())
            if (said) *said += dispute.text + "\n";
        return work;
    }
    uint64_t hash_of_saved() const
    {
        Document saved{
            .mask = Mask(ANNOTATED_SIZE), .trace = {}, .density = DensityField(ANNOTATED_SIZE, ANNOTATED_TYPE)};
        for (const Part part : PARTS)
            if (is_there(file_of(files(), part))) load(part, files(), saved);
        return hash_of(saved);
    }
};

void go_on(Work& work, std::mt19937& random, int steps)
{
    for (int i = 0; i < steps; ++i) work.perform(random_command(work.document(), random));
}

uint64_t hash_of_files(const Document& document)
{
    Document copy = document;
    copy.settings = {};
    copy.trace.select({});
    return hash_of(copy);
}

}  // namespace

TEST_CASE("files hold what was there when the save began; the rest stays unsaved, also after opening")
{
    Desk desk;
    std::mt19937 random(5);
    auto work = desk.open();
    go_on(*work, random, 40);
    const uint64_t at_begin = hash_of_files(work->document());
    const size_t before = work->unsaved();
    const auto saving = work->begin_save({});
    CHECK(work->is_saving());
    std::thread worker([&] { saving->write(); });
    go_on(*work, random, 25);
    work->undo();
    worker.join();
    const size_t since = work->unsaved() - before;
    CHECK(since > 10);
    const Work::Saved saved = work->end_save(*saving);
    CHECK_FALSE(work->is_saving());
    CHECK(saved.files.size() == 3);
    CHECK(saved.notices.empty());
    CHECK(work->unsaved() == since);
    CHECK(desk.hash_of_saved() == at_begin);
    const uint64_t now = hash_of(work->document());
    work.reset();
    std::string said;
    work = desk.open(&said);
    CHECK(said.find(sentence("holds ", since, " steps that were not saved")) != std::string::npos);
    CHECK(said.find("was changed") == std::string::npos);
    CHECK(hash_of(work->document()) == now);
    CHECK(work->unsaved() == since);
    // Back to the save: as it was when that began.
    REQUIRE(work->revert() != nullptr);
    CHECK(hash_of_files(work->document()) == at_begin);
    work->undo();
    work->save();
    CHECK(work->is_saved());
    CHECK(desk.hash_of_saved() == hash_of_files(work->document()));
    for (const auto& entry : std::filesystem::directory_iterator(desk.path))
        CHECK(entry.path().string().find(".old") == std::string::npos);
}

TEST_CASE("a save that was killed after some of its files is recognized, with what was done meanwhile")
{
    for (const bool is_written : {false, true}) {
        CAPTURE(is_written);
        Desk desk;
        std::mt19937 random(9);
        auto work = desk.open();
        go_on(*work, random, 30);
        work->save();
        go_on(*work, random, 30);
        const auto saving = work->begin_save({});
        go_on(*work, random, 10);
        const auto killed = [&] { throw Error("the power fails"); };
        if (is_written) CHECK_THROWS(saving->write(killed));  // all files, and not the mark
        const uint64_t now = hash_of(work->document());
        const size_t unsaved = work->unsaved();
        work->flush();
        work->end_save(*saving);
        CHECK(work->unsaved() == unsaved);
        work.reset();
        std::string said;
        work = desk.open(&said);
        CHECK(said.find(sentence("holds ", unsaved, " steps that were not saved")) != std::string::npos);
        CHECK(said.find("was changed") == std::string::npos);
        CHECK(hash_of(work->document()) == now);
        work->save();
        CHECK(work->is_saved());
        for (const auto& entry : std::filesystem::directory_iterator(desk.path))
            CHECK(entry.path().string().find(".old") == std::string::npos);
    }
}

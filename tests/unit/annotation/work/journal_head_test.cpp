// The head of a journal stands twice: damage to one copy is repaired, damage to both is reported.

#include "engine/annotation/work/journal_head.h"

#include <random>

#include <doctest/doctest.h>

#include "engine/annotation/work/journal.h"
#include "engine/annotation/work/work.h"
#include "tests/support/random_annotation.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

struct Sample : TemporaryFolder {
    explicit Sample(const std::string& hash = {})
    {
        files = files_in(path);
        files.volume_hash = hash;
        Work work(ANNOTATED_SIZE, ANNOTATED_TYPE);
        work.open(files);
        work.perform({"dab", {MaskBrickChange{.brick = 0, .runs = {{1, 9, 0, 3}}}}});
        work.save({}, [] {});
        work.flush();
        content = bytes_of_file(files.journal);
        const JournalScan scan = scan_journal(files.journal);
        front_bytes = scan.records.at(0).content_at + scan.records[0].stored_bytes;
        head_bytes = scan.records.at(1).content_at + scan.records[1].stored_bytes;
    }
    std::vector<std::byte> repaired(const std::string& damaged) const
    {
        return repaired_head(std::as_bytes(std::span(damaged)), "a.journal");
    }
    WorkFiles files;
    std::string content;
    size_t front_bytes = 0, head_bytes = 0;
};

std::string flipped(std::string content, size_t bit)
{
    content[bit / 8] = char(content[bit / 8] ^ (1 << bit % 8));
    return content;
}

const std::string LONG_HASH(64, 'a');  // compressed in the first record, never in the second

}  // namespace

TEST_CASE("every bit of either copy of the head is repaired from the other one")
{
    for (const std::string& hash : {std::string(), LONG_HASH}) {
        const Sample sample(hash);
        CHECK(sample.repaired(sample.content).empty());
        const std::string head = sample.content.substr(0, sample.head_bytes);
        size_t wrong = 0;
        for (size_t bit = 0; bit < 8 * sample.head_bytes; ++bit) {
            const std::vector<std::byte> repaired = sample.repaired(flipped(sample.content, bit));
            wrong += std::string(reinterpret_cast<const char*>(repaired.data()), repaired.size()) != head;
        }
        CHECK(wrong == 0);
    }
}

TEST_CASE("a whole copy that is overwritten is repaired, too")
{
    const Sample sample;
    std::string damaged = sample.content;
    std::fill(damaged.begin(), damaged.begin() + ptrdiff_t(sample.front_bytes), '\0');
    CHECK(sample.repaired(damaged).size() == sample.head_bytes);
    damaged = sample.content;
    std::fill(damaged.begin() + ptrdiff_t(sample.front_bytes), damaged.begin() + ptrdiff_t(sample.head_bytes), '\0');
    CHECK(sample.repaired(damaged).size() == sample.head_bytes);
}

TEST_CASE("work with a damaged head is opened whole, and its next writing repairs the head")
{
    const Sample sample(LONG_HASH);
    std::mt19937 random(7);
    for (int i = 0; i < 24; ++i) {
        const size_t bit = random() % (8 * sample.head_bytes);
        CAPTURE(bit);
        sample.write("a.journal", flipped(sample.content, bit));
        {
            Work looking(ANNOTATED_SIZE, ANNOTATED_TYPE);
            const std::vector<Notice> notices = looking.open(sample.files, {.only_look = true});
            REQUIRE(notices.size() == 1);
            CHECK(contains(notices[0].text, "a.journal: its first bytes are damaged; expected them as"));
            CHECK_FALSE(notices[0].is_loss);
            CHECK(looking.document().mask.voxels_by_group()[3] == 9);
        }
        CHECK(bytes_of_file(sample.files.journal) != sample.content);
        {
            Work work(ANNOTATED_SIZE, ANNOTATED_TYPE);
            work.open(sample.files);
            CHECK(work.undo() != nullptr);
        }
        CHECK(bytes_of_file(sample.files.journal).starts_with(sample.content));
        CHECK_FALSE(fs::exists(sample.path / "a.journal.rest1"));
    }
}

TEST_CASE("damage to both copies is reported with the command that keeps the rest, and nothing is changed")
{
    const Sample sample;
    std::mt19937 random(11);
    const size_t subject = 16 + 8;  // the first record's length, which no checksum can replace
    for (int i = 0; i < 200; ++i) {
        const size_t first = 8 * subject + random() % (8 * (sample.front_bytes - subject));
        const size_t second = 8 * (sample.front_bytes + 40) + random() % (8 * sample.front_bytes);
        CAPTURE(first);
        CAPTURE(second);
        const std::string damaged = flipped(flipped(sample.content, first), second);
        CHECK_THROWS_AS(sample.repaired(damaged), JournalDamaged);
        const std::string refusal = error_of([&] { sample.repaired(damaged); });
        CHECK(contains(refusal, "and so is their repetition"));
        CHECK(contains(refusal, "| shvr annotate \"a.json\" --script - --believe files"));
    }
}

TEST_CASE("of a journal whose head is lost, the saved files are taken if that is wanted, and the file is kept")
{
    const Sample sample;
    const std::string damaged = flipped(flipped(sample.content, 8 * 58), 8 * (sample.front_bytes + 40 + 58));
    sample.write("a.journal", damaged);
    for (const Belief belief : {Belief::ask, Belief::journal}) {
        Work work(ANNOTATED_SIZE, ANNOTATED_TYPE);
        CHECK_THROWS_AS(work.open(sample.files, {.belief = belief}), JournalDamaged);
    }
    CHECK(bytes_of_file(sample.files.journal) == damaged);
    {
        Work work(ANNOTATED_SIZE, ANNOTATED_TYPE);
        const std::vector<Notice> notices = work.open(sample.files, {.belief = Belief::files});
        REQUIRE(notices.size() == 1);
        CHECK(notices[0].is_loss);
        CHECK(work.document().mask.voxels_by_group()[3] == 9);
        work.save();
    }
    CHECK(bytes_of_file(sample.path / "a.journal.old") == damaged);
    Work work(ANNOTATED_SIZE, ANNOTATED_TYPE);
    CHECK(work.open(sample.files).empty());
    CHECK(work.document().mask.voxels_by_group()[3] == 9);
}

TEST_CASE("the first bytes of an older journal, which stand once, follow from its first record")
{
    const Sample sample;
    // Without the second record, all later ones would be of another chain: only the first two matter here.
    const std::string older = sample.content.substr(0, sample.front_bytes);
    CHECK(sample.repaired(older).empty());
    size_t wrong = 0;
    for (size_t bit = 0; bit < 8 * 16; ++bit) {
        const std::vector<std::byte> repaired = sample.repaired(flipped(older, bit));
        wrong += std::string(reinterpret_cast<const char*>(repaired.data()), repaired.size()) != older;
    }
    CHECK(wrong == 0);
    // Two bits make it a newer program's.
    CHECK(sample.repaired(flipped(flipped(older, 8 * 8), 8 * 8 + 1)).empty());
}

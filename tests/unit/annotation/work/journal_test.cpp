// The journal's file: it returns what was appended, and never the results of damage.

#include "engine/annotation/work/journal.h"

#include <sys/stat.h>

#include <algorithm>
#include <random>

#include <doctest/doctest.h>

#include "engine/annotation/work/journal_record.h"
#include "tests/support/random_annotation.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

std::vector<std::byte> bytes_of_text(const std::string& text)
{
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

/// A journal with records of many lengths; where each of them ends in the file.
struct Sample {
    explicit Sample(const fs::path& journal) : path(journal)
    {
        {
            Journal made(path, {});
            for (int i = 0; i < 12; ++i)
                made.append(RecordKind(1 + i % 8), "record " + std::to_string(i),
                            bytes_of_text(std::string(size_t(i * i), char('a' + i % 3))), RecordNumber(i));
            made.flush();
        }
        for (const JournalRecord& record : scan_journal(path).records)
            ends.push_back(record.content_at + record.stored_bytes);
        content = bytes_of_file(path);
    }
    size_t records_in(uint64_t bytes) const
    {
        return size_t(std::upper_bound(ends.begin(), ends.end(), bytes) - ends.begin());
    }
    fs::path path;
    std::vector<uint64_t> ends;
    std::string content;
};

}  // namespace

TEST_CASE("a journal holds the records it was given, in one go or in several")
{
    const TemporaryFolder folder;
    const fs::path path = folder.path / "a.journal";
    std::mt19937 random(3);
    std::vector<std::vector<std::byte>> contents;
    for (int round = 0; round < 3; ++round) {
        Journal journal(path, scan_journal(path));
        for (int i = 0; i < 20; ++i) {
            std::vector<std::byte> content(random() % 5000);
            for (std::byte& byte : content) byte = std::byte(random() % (round == 0 ? 256 : 3));
            CHECK(journal.append(RecordKind::command, "label", content, 7) == contents.size() + 1);
            contents.push_back(std::move(content));
        }
        if (round == 1) continue;  // closing also flushes
        journal.flush();
        CHECK(journal.durable() == contents.size());
        CHECK(journal.bytes() == fs::file_size(path));
        for (RecordNumber number = 1; number <= contents.size(); ++number)
            CHECK((journal.read(number) == contents[number - 1]));
    }
    const JournalScan scan = scan_journal(path);
    REQUIRE(scan.records.size() == 60);
    CHECK(scan.end == scan.file_bytes);
    CHECK(scan.records[59].label == "label");
    CHECK(scan.records[59].about == 7);
}

TEST_CASE("a journal cut at any byte is the records that are whole before it, and goes on after them")
{
    const TemporaryFolder folder;
    const Sample sample(folder.path / "a.journal");
    REQUIRE(sample.ends.size() == 12);
    for (size_t bytes = 0; bytes <= sample.content.size(); ++bytes) {
        CAPTURE(bytes);
        const fs::path cut = folder.write("cut.journal", sample.content.substr(0, bytes));
        const JournalScan scan = scan_journal(cut);
        const size_t whole = sample.records_in(bytes);
        REQUIRE(scan.records.size() == whole);
        if (bytes % 7 != 0) continue;
        {
            Journal journal(cut, scan);
            journal.append(RecordKind::command, "more", bytes_of_text("more"));
        }
        const JournalScan more = scan_journal(cut);
        REQUIRE(more.records.size() == whole + 1);
        CHECK(more.end == more.file_bytes);
        const fs::path rest = folder.path / "cut.journal.rest1";
        const uint64_t kept = whole > 0 ? sample.ends[whole - 1] : bytes < 16 ? 0 : 16;
        CHECK(fs::exists(rest) == (bytes > kept));
        if (bytes > kept) CHECK(bytes_of_file(rest) == sample.content.substr(kept, bytes - kept));
        fs::remove(rest);
    }
}

TEST_CASE("a bit that turned ends a journal before its record, wherever it is")
{
    const TemporaryFolder folder;
    const Sample sample(folder.path / "a.journal");
    for (size_t byte = 16; byte < sample.content.size(); ++byte)
        for (const int bit : {0, 3, 7}) {
            CAPTURE(byte);
            CAPTURE(bit);
            std::string damaged = sample.content;
            damaged[byte] = char(damaged[byte] ^ (1 << bit));
            const JournalScan scan = scan_journal(folder.write("b.journal", damaged));
            REQUIRE(scan.records.size() == sample.records_in(byte));
        }
}

TEST_CASE("records of one journal are none in another, and none in another order")
{
    const TemporaryFolder folder;
    const Sample sample(folder.path / "a.journal");
    const auto record = [&](size_t i) {
        return sample.content.substr(sample.ends[i - 1], sample.ends[i] - sample.ends[i - 1]);
    };
    const std::string first_three = sample.content.substr(0, sample.ends[2]);
    CHECK(scan_journal(folder.write("b.journal", first_three + record(3))).records.size() == 4);
    CHECK(scan_journal(folder.write("b.journal", first_three + record(4))).records.size() == 3);
    CHECK(scan_journal(folder.write("b.journal", first_three + record(2))).records.size() == 3);
}

TEST_CASE("a journal whose header no disk has seen yet, as a power cut leaves it, has just begun")
{
    const TemporaryFolder folder;
    const std::vector<std::byte> header = journal_header();
    for (size_t bytes = 0; bytes <= header.size(); ++bytes)
        for (size_t zeros = 0; zeros <= bytes; ++zeros) {
            std::string content(reinterpret_cast<const char*>(header.data()), bytes);
            std::fill(content.end() - ptrdiff_t(zeros), content.end(), '\0');
            const fs::path path = folder.write("a.journal", content);
            CHECK(scan_journal(path).records.empty());
            {
                Journal journal(path, scan_journal(path));
                journal.append(RecordKind::command, "a step", bytes_of_text("x"));
                journal.flush();
            }
            CHECK(scan_journal(path).records.size() == 1);
            fs::remove(path);
            fs::remove(folder.path / "a.journal.rest1");
        }
    // More than a header was never written before the header was on disk.
    folder.write("a.journal", std::string(header.size() + 1, '\0'));
    CHECK(contains(error_of([&] { scan_journal(folder.path / "a.journal"); }), "does not begin with SHVRJRNL"));
}

TEST_CASE("what is no journal, or a newer program's, is refused in words")
{
    const TemporaryFolder folder;
    const Sample sample(folder.path / "a.journal");
    const auto refusal = [&](const std::string& content) {
        const fs::path path = folder.write("b.journal", content);
        return error_of([&] { scan_journal(path); });
    };
    CHECK(contains(refusal("SHVR journal?"), "does not begin with SHVRJRNL; expected a journal"));
    std::string newer = sample.content;
    newer[8] = 2;
    CHECK(contains(refusal(newer), "is a journal of version 2; expected 1"));
    const fs::path unknown = folder.path / "c.journal";
    Journal(unknown, {}).append(RecordKind(10), "", {});
    CHECK(contains(error_of([&] { scan_journal(unknown); }),
                   "record 1 is of kind 10, which this program does not know; expected 1 to 9"));
    const fs::path addition = folder.path / "d.journal";
    Journal(addition, {}).append(RecordKind(FIRST_ADDITION), "", {});
    CHECK(scan_journal(addition).records.size() == 1);
    fs::create_directory(folder.path / "e.journal");
    CHECK(contains(error_of([&] { scan_journal(folder.path / "e.journal"); }), "is not a regular file"));
    REQUIRE(::mkfifo((folder.path / "f.journal").c_str(), 0600) == 0);
    CHECK(contains(error_of([&] { scan_journal(folder.path / "f.journal"); }), "is not a regular file"));
    CHECK(contains(error_of([&] { Journal(folder.path / "no folder" / "g.journal", {}); }),
                   "g.journal: cannot be written: No such file or directory"));
}

TEST_CASE("a journal has one writer, who has read what it holds")
{
    const TemporaryFolder folder;
    const fs::path path = folder.path / "a.journal";
    {
        Journal one(path, {});
        CHECK_THROWS_AS(Journal(path, scan_journal(path)), JournalTaken);
        one.append(RecordKind::undo, "", {});
        one.flush();
        CHECK(scan_journal(path).records.size() == 1);  // reading needs no lock
    }
    const JournalScan early = scan_journal(path);
    Journal(path, early).append(RecordKind::redo, "", {});
    CHECK_THROWS_AS(Journal(path, early), JournalTaken);
    CHECK(contains(error_of([&] { Journal(path, early); }), "another process has written it since it was read"));
}

TEST_CASE("records are read as they were written; cut or turned, they are refused or something else")
{
    std::mt19937 random(11);
    Document document = unannotated();
    int fitting = 0, refused = 0;
    for (int i = 0; i < 60; ++i) {
        const Command command = random_command(document, random);
        const std::vector<std::byte> bytes = bytes_of(command.changes);
        CHECK((changes_of(bytes) == command.changes));
        for (size_t cut = 0; cut < std::min<size_t>(bytes.size(), 200); ++cut) {
            try {
                const size_t read = changes_of(std::span(bytes).first(cut)).size();
                CHECK(read <= command.changes.size());
            } catch (const Error&) {
            }
        }
        for (int turns = 0; turns < 50 && !bytes.empty(); ++turns) {
            std::vector<std::byte> turned = bytes;
            turned[random() % turned.size()] ^= std::byte(1 << random() % 8);
            Document trial = document;
            try {
                apply_if_it_fits(trial, changes_of(turned), Direction::forwards);
                ++fitting;
            } catch (const Error&) {
                REQUIRE(hash_of(trial) == hash_of(document));
                REQUIRE((trial.trace.selection() == document.trace.selection()));
                ++refused;
            }
        }
        apply_if_it_fits(document, command.changes, Direction::forwards);
    }
    CHECK(fitting > 100);
    CHECK(refused > 100);
    const std::vector<std::byte> whole = bytes_of(document);
    const Document read = document_of(whole, unannotated());
    CHECK(hash_of(read) == hash_of(document));
    CHECK((read.trace.selection() == document.trace.selection()));
    CHECK(read.trace.next_node() == document.trace.next_node());
    const JournalSubject subject{ANNOTATED_SIZE, VoxelType::uint16, "xxh3-128:0"};
    CHECK((subject_of(bytes_of(subject)) == subject));
    const SettingValues kept{{"view", "{}"}, {"", ""}};
    CHECK(setting_values_of(bytes_of(kept)) == kept);
    const JournalSpace space{{0.1, 2.0, 1e-7}, "um"};
    CHECK((space_of(bytes_of(space)) == space));
    for (const auto& settings :
         {std::optional<SettingValues>(), std::optional<SettingValues>(SettingValues{{"light", "{}"}})}) {
        const SavedFiles files{1, std::nullopt, 3, settings};
        CHECK((saved_files_of(bytes_of(files)) == files));
    }
}

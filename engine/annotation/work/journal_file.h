#pragma once
// The journal's file: 16 bytes ("SHVRJRNL", a version, zeros), then any number of records, each of
//
//     kind 4 | flags 2 | label's length 2 | stored length 8 | length 8 | about 8 | checksum 8 | label | content
//
// little-endian. Flag 1: the content is a zstd frame. The checksum is XXH3-64 of the whole record except itself, seeded
// with the checksum of the previous record, so that records are valid in their order or not at all. Readers take the
// longest valid prefix. Kinds from 128 on are additions that readers may skip; an unknown kind below 128 is from a
// newer program, and the journal is refused. A record's number is its position in the file, from 1. The first 16 bytes
// and the first record are stored twice (journal_head.h).
//
// Any thread may call these.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/annotation/work/history.h"
#include "engine/base/file.h"

namespace shvr {

enum class RecordKind : uint32_t {
    subject = 1,  ///< JournalSubject; always the first record of a journal, and only that
    state,        ///< the whole document after record `about`
    command,      ///< label, changes
    extension,    ///< changes that continue the preceding command
    undo,
    redo,
    saving,  ///< start of a save: from here on each saved file may be the old or the new one
    /// SavedFiles. `about`: number of the last `kept` record that the session's file reflected; 0: unknown.
    saved,
    /// JournalSpace: from here on positions are in another spacing; earlier ones are converted when they are read.
    /// Older programs would mix the two spacings, so this kind makes them refuse the journal.
    respaced,
    /// SavedFiles, with `about` as in `saved`: the user has decided about files changed by other programs, so from here
    /// on the present state of these files is known. Older programs skip the record and ask (or take the files) again.
    known = 128,
    /// SettingValues: all kept settings that changed since the record `about` or, if that is 0, all kept settings.
    /// Older programs skip these records and use the settings of the session's file.
    kept = 129,
    /// JournalSpace, once: the space of this journal's positions. Older programs skip it and accept any spacing.
    space = 130,
    /// The second record: an uncompressed copy of all bytes before it. Older programs skip it.
    head = 131,
    /// JournalTime: the time of day of the steps after it, up to the next such record. Nothing but a reader of times
    /// uses it: equal work has equal documents and histories, whenever it was done. Older programs skip it.
    time = 132,
};
constexpr RecordKind LAST_KIND = RecordKind::respaced;  ///< the last kind that is not an addition
constexpr uint32_t FIRST_ADDITION = 128;

struct JournalRecord {
    RecordKind kind{};
    std::string label;
    RecordNumber about = 0;
    uint64_t content_at = 0;  ///< offset in the file
    uint64_t stored_bytes = 0;
    uint64_t bytes = 0;
    bool is_compressed = false;
    uint64_t checksum = 0;
};

/// The readable part of a journal: empty if there is no file.
struct JournalScan {
    std::vector<JournalRecord> records;
    uint64_t end = 0;         ///< end of the valid prefix
    uint64_t file_bytes = 0;  ///< including unreadable data at the end
    uint64_t inode = 0;       ///< 0: there is no file
    /// Bytes that replace the beginning of the file, if bytes there are damaged; otherwise empty.
    std::vector<std::byte> head{};

    /// Checksum of the last record; 0 if there is none.
    uint64_t checksum() const { return records.empty() ? 0 : records.back().checksum; }
    /// Keeps only the first records.
    void cut(size_t count);
};

/// More than any single command paints; larger sizes are refused before memory is allocated.
constexpr uint64_t MAX_RECORD_BYTES = uint64_t{1} << 30;

/// Fails if the file is not a journal, is from a newer program, or cannot be read; fails with JournalDamaged if the
/// journal's head is beyond repair.
JournalScan scan_journal(const std::filesystem::path& path);

/// The content of a record. Fails if the file no longer holds it. `head`: as in JournalScan.
std::vector<std::byte> content_of(const JournalRecord& record, const FileDescriptor& file,
                                  const std::filesystem::path& path, std::span<const std::byte> head = {});

constexpr size_t MAGIC_BYTES = 8, VERSION_BYTES = 4, RECORD_HEADER_BYTES = 40;
/// The record at the beginning of `bytes`, with `content_at` relative to it; null if it is cut or damaged.
struct ParsedRecord {
    JournalRecord record;
    size_t bytes = 0;  ///< size of the whole record
};
std::optional<ParsedRecord> parse_record(std::span<const std::byte> bytes, uint64_t checksum_before);

/// The 16 bytes at the start of the file.
std::vector<std::byte> journal_header();
/// The bytes of a record; completes `record`. Replaces `checksum`, the previous record's, by this record's.
std::vector<std::byte> framed(JournalRecord& record, std::span<const std::byte> content, uint64_t& checksum);

/// XXH3-64 of a file's bytes, or of all files of a folder with their names; null if there is none.
std::optional<uint64_t> file_digest(const std::filesystem::path& path);
/// The digest of a file that would hold these bytes.
uint64_t digest_of(std::span<const std::byte> bytes);

}  // namespace shvr

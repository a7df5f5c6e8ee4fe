#pragma once
// The journal's file: 16 bytes ("SHVRJRNL", a version, zeros), then any number of records, each of the form
//
//     kind 4 | flags 2 | label's length 2 | stored length 8 | length 8 | about 8 | checksum 8 | label | content
//
// with sizes in bytes, little-endian. Flag 1: the content is a zstd frame. The checksum is XXH3-64 of the whole record
// except itself, seeded with the previous record's checksum, so a record is valid only after its predecessors. Readers
// take the longest valid prefix. Kinds from 128 on are additions that readers may skip. An unknown kind below 128 is
// from a newer program, and the journal is refused. A record's number is its position in the file, from 1. The first 16
// bytes and the first record are stored twice (journal_head.h).
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
    subject = 1,  ///< JournalSubject; the first record of every journal, and no other
    state,        ///< the whole document after record `about`
    command,      ///< label, changes
    extension,    ///< changes that continue the preceding command
    undo,
    redo,
    saving,  ///< start of a save: from here on, each saved file may be in its old or new state
    /// SavedFiles. `about`: number of the last `kept` record whose values are in the session's file; 0: unknown.
    saved,
    /// JournalSpace: later positions are in another spacing; readers convert earlier positions to it. Older programs
    /// would mix the two spacings; as the kind is below 128, they refuse the journal.
    respaced,
    /// SavedFiles, with `about` as in `saved`: the user has decided about files changed by other programs, so their
    /// present state is known from here on. Older programs skip this record and ask (or take the files) again.
    known = 128,
    /// SettingValues: the kept settings that changed since the record `about` or, if `about` is 0, all kept settings.
    /// Older programs skip these records and use the settings of the session's file.
    kept = 129,
    /// JournalSpace, once: the space of this journal's positions. Older programs skip it and accept any spacing.
    space = 130,
    /// The second record: an uncompressed copy of all bytes before it. Older programs skip this record.
    head = 131,
    /// JournalTime: the time of the following steps, up to the next such record. It affects no document and no history,
    /// so equal work gives equal results at any time. Older programs skip this record.
    time = 132,
};
constexpr RecordKind LAST_KIND = RecordKind::respaced;  ///< the last kind that older programs must not skip
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

/// The readable part of a journal; empty if there is no file.
struct JournalScan {
    std::vector<JournalRecord> records;
    uint64_t end = 0;         ///< end of the valid prefix
    uint64_t file_bytes = 0;  ///< including unreadable data at the end
    uint64_t inode = 0;       ///< 0: there is no file
    /// Bytes to read in place of the file's first bytes, if some of those are damaged; otherwise empty.
    std::vector<std::byte> head{};

    /// Checksum of the last record; 0 if there is none.
    uint64_t checksum() const { return records.empty() ? 0 : records.back().checksum; }
    /// Keeps only the first records.
    void cut(size_t count);
};

/// No single command needs more. Larger sizes are refused before memory is allocated.
constexpr uint64_t MAX_RECORD_BYTES = uint64_t{1} << 30;

/// Fails if the file is not a journal, is from a newer program, or cannot be read. Fails with JournalDamaged if the
/// journal's head cannot be repaired.
JournalScan scan_journal(const std::filesystem::path& path);

/// The content of a record. Fails if the file no longer contains it. `head`: as in JournalScan.
std::vector<std::byte> content_of(const JournalRecord& record, const FileDescriptor& file,
                                  const std::filesystem::path& path, std::span<const std::byte> head = {});

constexpr size_t MAGIC_BYTES = 8, VERSION_BYTES = 4, RECORD_HEADER_BYTES = 40;
/// The record at the start of `bytes`, with `content_at` relative to it; null if the record is incomplete or damaged.
struct ParsedRecord {
    JournalRecord record;
    size_t bytes = 0;  ///< size of the whole record
};
std::optional<ParsedRecord> parse_record(std::span<const std::byte> bytes, uint64_t checksum_before);

/// The 16 bytes at the start of the file.
std::vector<std::byte> journal_header();
/// Returns a record's bytes and completes `record`. `checksum`: in: the previous record's; out: this record's.
std::vector<std::byte> framed(JournalRecord& record, std::span<const std::byte> content, uint64_t& checksum);

/// XXH3-64 of a file's bytes, or of the names and bytes of all files in a folder; null if there is no such file.
std::optional<uint64_t> file_digest(const std::filesystem::path& path);
/// The digest of a file that contains these bytes.
uint64_t digest_of(std::span<const std::byte> bytes);

}  // namespace shvr

#pragma once
// The journal's file: 16 bytes ("SHVRJRNL", a version, zeros), then any number of records, each of
//
//     kind 4 | flags 2 | label's length 2 | stored length 8 | length 8 | about 8 | checksum 8 | label | content
//
// little-endian. Flag 1: the content is a zstd frame. The checksum is XXH3-64 of the whole record but itself, seeded
// with the checksum of the record before, so that records are valid in their order or not at all. Readers take the
// longest valid prefix. Kinds from 128 on are additions that readers may skip; an unknown kind below that is from a
// newer program, and refused. A record's number is its place in the file, from 1.
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
    subject = 1,  ///< JournalSubject; the first record of every journal, and nowhere else
    state,        ///< the whole document after record `about`
    command,      ///< label, changes
    extension,    ///< changes that continue the command before
    undo,
    redo,
    saving,  ///< from here on each saved file may be the old or the new one
    /// SavedFiles. `about`: the `kept` record up to which the session's file held the kept settings; 0: not known.
    saved,
    /// JournalSpace: from here on positions are in another spacing; those before are converted when they are read.
    /// Older programs would mix the two, so that they refuse it.
    respaced,
    /// SavedFiles, `about` as in `saved`: a choice was made about files that others had changed; from here on they are
    /// known as they are. Older programs skip it, and ask (or take the files) again.
    known = 128,
    /// SettingValues: kept settings that were changed since the record `about`, or (0) all of them. Older programs skip
    /// them, and show what the session's file says.
    kept = 129,
    /// JournalSpace, once: of the positions in this journal. Older programs skip it, and take any spacing.
    space = 130,
};
constexpr RecordKind LAST_KIND = RecordKind::respaced;  ///< of those that are no additions
constexpr uint32_t FIRST_ADDITION = 128;

struct JournalRecord {
    RecordKind kind{};
    std::string label;
    RecordNumber about = 0;
    uint64_t content_at = 0;  ///< in the file
    uint64_t stored_bytes = 0;
    uint64_t bytes = 0;
    bool is_compressed = false;
    uint64_t checksum = 0;
};

/// The readable part of a journal: empty if there is no file.
struct JournalScan {
    std::vector<JournalRecord> records;
    uint64_t end = 0;         ///< of the valid prefix
    uint64_t file_bytes = 0;  ///< including unreadable data at the end
    uint64_t inode = 0;       ///< 0: there is no file

    /// Of the last record; 0 if there is none.
    uint64_t checksum() const { return records.empty() ? 0 : records.back().checksum; }
    /// Keeps only the first records.
    void cut(size_t count);
};

/// More than any single command paints; larger claims are refused before memory is allocated.
constexpr uint64_t MAX_RECORD_BYTES = uint64_t{1} << 30;

/// Fails if the file is not a journal, is from a newer program, or cannot be read.
JournalScan scan_journal(const std::filesystem::path& path);

/// The content of a record. Fails if the file no longer holds it.
std::vector<std::byte> content_of(const JournalRecord& record, const FileDescriptor& file,
                                  const std::filesystem::path& path);

/// The 16 bytes.
std::vector<std::byte> journal_header();
/// A record's bytes. `checksum`: of the record before; becomes this record's. Completes `record`.
std::vector<std::byte> framed(JournalRecord& record, std::span<const std::byte> content, uint64_t& checksum);

/// XXH3-64 of a file's bytes, or of all files of a folder with their names; nothing if there is none.
std::optional<uint64_t> file_digest(const std::filesystem::path& path);
/// The same of a file that would hold these bytes.
uint64_t digest_of(std::span<const std::byte> bytes);

}  // namespace shvr

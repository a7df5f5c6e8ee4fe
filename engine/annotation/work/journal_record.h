#pragma once
// The contents of records as bytes: little-endian; integers in groups of 7 bits, lowest first (LEB128), doubles as
// their bits. Any thread may call these.
//
// Readers trust no content: lengths are checked against the bytes present before memory is allocated. A change that was
// read may still not fit the document (Mask::why_it_does_not_fit and its equivalents for other kinds).

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/annotation/trace/trace_file.h"
#include "engine/annotation/work/history.h"
#include "engine/annotation/work/respacing.h"
#include "engine/volume/volume.h"

namespace shvr {

/// Identifies the annotated volume. Two scans of the same size differ in `image`.
struct JournalSubject {
    Size3 size{0};
    VoxelType type = VoxelType::uint8;
    std::string image{};  ///< the volume's content hash; empty if it was not computed
    bool operator==(const JournalSubject&) const = default;
};

/// Label of the first `saved` record if the work was started empty next to files of earlier work. Those files do not
/// count as saves of the new work.
inline constexpr char AFRESH[] = "afresh";

/// The state of the files with the annotation, as the journal last recorded it; null: no file.
struct SavedFiles {
    std::optional<uint64_t> mask, trace, density;  ///< file_digest
    std::optional<SettingValues> settings{};       ///< settings written to the session's file; unknown in old journals
    bool operator==(const SavedFiles&) const = default;
};

/// When steps were made.
struct JournalTime {
    int64_t time_ms = 0;  ///< since 1970-01-01 00:00 UTC, without leap seconds
};

std::vector<std::byte> bytes_of(const JournalSubject& subject);
std::vector<std::byte> bytes_of(const JournalSpace& space);
std::vector<std::byte> bytes_of(const JournalTime& time);
std::vector<std::byte> bytes_of(const SavedFiles& files);
std::vector<std::byte> bytes_of(const SettingValues& values);
std::vector<std::byte> bytes_of(std::span<const Change> changes);
/// The whole document as bytes: the changes that make it from an empty document, and the trace's next numbers.
std::vector<std::byte> bytes_of(const Document& document);

/// These functions read a record's content. On failure they state only the reason; callers add the file's name.
JournalSubject subject_of(std::span<const std::byte> bytes);
JournalSpace space_of(std::span<const std::byte> bytes);
JournalTime time_of(std::span<const std::byte> bytes);
SavedFiles saved_files_of(std::span<const std::byte> bytes);
SettingValues setting_values_of(std::span<const std::byte> bytes);
std::vector<Change> changes_of(std::span<const std::byte> bytes);
/// `empty`: an empty document of the same volume. `convert` is called with each change before it is applied.
Document document_of(std::span<const std::byte> bytes, Document empty,
                     const std::function<void(Change&)>& convert = {});

}  // namespace shvr

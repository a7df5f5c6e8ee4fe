#pragma once
// What the journal holds, as bytes: numbers little-endian, whole ones in groups of 7 bits with the lowest first (LEB128),
// doubles as their bits. Any thread may call these.
//
// Reading trusts nothing: lengths are checked against the bytes that are there before memory is taken, and what comes out
// may still not fit a document (Mask::why_it_does_not_fit and the same of other kinds).

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/annotation/trace/trace_file.h"
#include "engine/annotation/work/history.h"
#include "engine/volume/volume.h"

namespace shvr {

/// What is annotated. Two scans of one size differ in `image`.
struct JournalSubject {
    Size3 size{0};
    VoxelType type = VoxelType::uint8;
    std::string image{};  ///< the volume's content hash; empty where nobody has gone through it
    bool operator==(const JournalSubject&) const = default;
};

/// The files that hold the annotation between sessions, as they were when the journal last saw them; nothing: no file.
struct SavedFiles {
    std::optional<uint64_t> mask, trace, density;  ///< file_digest
    bool operator==(const SavedFiles&) const = default;
};

std::vector<std::byte> bytes_of(const JournalSubject& subject);
std::vector<std::byte> bytes_of(const SavedFiles& files);
std::vector<std::byte> bytes_of(std::span<const Change> changes);
/// All of the document, as what leads to it from nothing, and the trace's numbers to come.
std::vector<std::byte> bytes_of(const Document& document);

/// Fail with what is wrong, without a file's name.
JournalSubject subject_of(std::span<const std::byte> bytes);
SavedFiles saved_files_of(std::span<const std::byte> bytes);
std::vector<Change> changes_of(std::span<const std::byte> bytes);
/// `empty`: a document of the same volume without anything in it.
Document document_of(std::span<const std::byte> bytes, Document empty);

}  // namespace shvr

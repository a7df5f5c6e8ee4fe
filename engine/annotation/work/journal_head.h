#pragma once
// The head of a journal: its first 16 bytes (the header) and its first record,
// which identifies the volume. A flipped bit there would make the whole
// journal unreadable, so the head is stored twice: the second record, `head`,
// repeats it and contains nothing else. If one copy is damaged, the other
// replaces it.
//
// Older journals have no record `head`. Their header can be restored if the
// first record is sound; their first record has no copy.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "engine/annotation/work/journal_file.h"
#include "engine/base/error.h"

namespace shvr {

/// Thrown if both copies of a journal's head are damaged.
class JournalDamaged : public Error {
public:
    using Error::Error;
};

/// The head is searched for in this many bytes at the start of a file.
constexpr size_t MAX_HEAD_BYTES = 65536;

/// The content of the record `head` in a journal whose first record has the content `subject`.
std::vector<std::byte> repeated_head(std::span<const std::byte> subject);

/// Returns the right bytes for the start of the file if some bytes there are damaged; empty if none are, or if the
/// right bytes are unknown. `begin`: the file's first bytes, at most MAX_HEAD_BYTES. Fails with JournalDamaged.
std::vector<std::byte> repaired_head(std::span<const std::byte> begin, const std::filesystem::path& path);

}  // namespace shvr

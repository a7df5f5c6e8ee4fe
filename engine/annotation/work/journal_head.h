#pragma once
// The head of a journal: its first 16 bytes and its first record, which identifies the volume. A flipped bit there
// would make all that follows unreadable, so both are stored twice: the second record, `head`, repeats them and is
// itself determined by them. The sound copy restores the damaged one.
//
// Older journals have no record `head`. Their first 16 bytes are known if a sound first record follows; their first
// record has no copy.
//
// Any thread may call these.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "engine/annotation/work/journal_file.h"
#include "engine/base/error.h"

namespace shvr {

/// A journal whose head is damaged in both copies.
class JournalDamaged : public Error {
public:
    using Error::Error;
};

/// Size of the beginning of a file in which the head is searched for.
constexpr size_t MAX_HEAD_BYTES = 65536;

/// The content of the record `head`, for a journal whose first record has the content `subject`.
std::vector<std::byte> repeated_head(std::span<const std::byte> subject);

/// Returns the bytes that belong at the file's beginning if some are damaged; empty if none is, or if the right bytes
/// are unknown. `begin`: the file's first bytes, at most MAX_HEAD_BYTES. Fails with JournalDamaged.
std::vector<std::byte> repaired_head(std::span<const std::byte> begin, const std::filesystem::path& path);

}  // namespace shvr

#pragma once
// The head of a journal: its first 16 bytes and its first record, which says of which volume it is. A flipped bit there
// would make all that follows unreadable, so both stand twice: the record `head`, the second one, repeats them, and is
// itself determined by them. Whichever copy is sound gives the other one.
//
// Older journals have no such record. Their first 16 bytes are known, if a sound first record follows; their first
// record stands once.
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

/// The beginning of a file in which a head is looked for.
constexpr size_t MAX_HEAD_BYTES = 65536;

/// The content of the record `head`, for a journal whose first record has this content.
std::vector<std::byte> repeated_head(std::span<const std::byte> subject);

/// `begin`: the file's first bytes, at most MAX_HEAD_BYTES. Returns the bytes that should stand there if some of
/// them are damaged; nothing if none is, or if nothing is known about them. Fails with JournalDamaged.
std::vector<std::byte> repaired_head(std::span<const std::byte> begin, const std::filesystem::path& path);

}  // namespace shvr

#include "engine/annotation/work/journal_head.h"

#include <algorithm>
#include <bit>
#include <optional>

#include "engine/base/text.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;

using Bytes = std::span<const std::byte>;

/// Tolerated number of flipped bits among the 64 bits of the magic "SHVRJRNL"; other files differ in more bits.
constexpr int MAX_DAMAGED_BITS = 8;

int bits_between(Bytes a, Bytes b)
{
    int bits = 0;
    for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) bits += std::popcount(uint8_t(a[i] ^ b[i]));
    return bits;
}

bool are_equal(Bytes a, Bytes b)
{
    return std::ranges::equal(a, b);
}

/// Size and checksum of the file's first record; null if that record is damaged.
struct First {
    size_t bytes = 0;
    uint64_t checksum = 0;
};
std::optional<First> first_record(Bytes bytes)
{
    const std::optional<ParsedRecord> parsed = parse_record(bytes, 0);
    if (!parsed || parsed->record.kind != RecordKind::subject) return std::nullopt;
    return First{parsed->bytes, parsed->record.checksum};
}

/// Makes the second record, of kind `head`. Its content, the argument `head`, is the header and the first record.
std::vector<std::byte> second_record(Bytes head, uint64_t checksum)
{
    JournalRecord record{.kind = RecordKind::head};
    return framed(record, head, checksum);
}

/// The header and the first record at the start of the file; empty if either is damaged.
Bytes sound_front(Bytes begin)
{
    const std::vector<std::byte> header = journal_header();
    if (begin.size() < header.size() || !are_equal(begin.first(header.size()), header)) return {};
    const std::optional<First> first = first_record(begin.subspan(header.size()));
    return first ? begin.first(header.size() + first->bytes) : Bytes{};
}

/// Start of the repetition: a (perhaps damaged) "SHVRJRNL" after the header. Null if there is none.
std::optional<size_t> place_of_repetition(Bytes begin)
{
    const std::vector<std::byte> header = journal_header();
    const Bytes magic = Bytes(header).first(MAGIC_BYTES);
    for (size_t at = header.size() + RECORD_HEADER_BYTES; at + magic.size() <= begin.size(); ++at)
        if (bits_between(begin.subspan(at, magic.size()), magic) <= MAX_DAMAGED_BITS) return at;
    return std::nullopt;
}

/// Like `sound_front`, but taken from the repetition.
Bytes sound_repetition(Bytes begin)
{
    const std::optional<size_t> at = place_of_repetition(begin);
    if (!at) return {};
    const Bytes front = sound_front(begin.subspan(*at));
    // At this very place, it must be the repetition of this journal's head, not content that quotes another journal.
    return *at == front.size() + RECORD_HEADER_BYTES ? front : Bytes{};
}

/// A journal with another version, in undamaged bytes, is from a newer program. Newer programs must use version numbers
/// that differ from 1 in at least two bits, so that one flipped bit does not look like a newer version.
bool is_newer(Bytes begin)
{
    const std::vector<std::byte> header = journal_header();
    return are_equal(begin.first(MAGIC_BYTES), Bytes(header).first(MAGIC_BYTES)) &&
           bits_between(begin.subspan(MAGIC_BYTES, VERSION_BYTES), Bytes(header).subspan(MAGIC_BYTES, VERSION_BYTES)) >
               1;
}

/// The bytes that should be at the start of the file: `front`, then its repetition if the journal has one.
std::vector<std::byte> expected_head(Bytes begin, Bytes front, bool has_repetition)
{
    std::vector<std::byte> head(front.begin(), front.end());
    const uint64_t checksum = first_record(front.subspan(journal_header().size()))->checksum;
    const std::vector<std::byte> repetition = second_record(front, checksum);
    const Bytes next = begin.subspan(std::min(begin.size(), head.size()));
    if (!has_repetition && !parse_record(next, checksum) && next.size() >= repetition.size()) {
        // If the records after these bytes continue the journal, the bytes are a damaged repetition; otherwise they are
        // no repetition.
        const Bytes after = next.subspan(repetition.size());
        JournalRecord record{.kind = RecordKind::head};
        uint64_t seed = checksum;
        static_cast<void>(framed(record, front, seed));
        has_repetition = parse_record(after, seed).has_value() ||
                         bits_between(next.first(repetition.size()), repetition) <= MAX_DAMAGED_BITS;
    }
    if (has_repetition) head.insert(head.end(), repetition.begin(), repetition.end());
    return head;
}

[[noreturn]] void refuse(const fs::path& path)
{
    const std::string session = in_quotes(fs::path(path).replace_extension(".json").string());
    fs::path kept = path;
    kept += ".old";
    throw JournalDamaged(
        sentence(path.string(), ": its first bytes, which say that it is a journal and of which volume,",
                 " are damaged, and so is their repetition; expected one of them sound; to keep the ",
                 "saved files, and this file as ", kept.filename().string(),
                 ": echo '{\"op\":\"save\"}' | shvr annotate ", session, " --script - --believe files"));
}

}  // namespace

std::vector<std::byte> repeated_head(std::span<const std::byte> subject)
{
    std::vector<std::byte> head = journal_header();
    JournalRecord record{.kind = RecordKind::subject};
    uint64_t checksum = 0;
    const std::vector<std::byte> first = framed(record, subject, checksum);
    head.insert(head.end(), first.begin(), first.end());
    return head;
}

std::vector<std::byte> repaired_head(std::span<const std::byte> begin, const fs::path& path)
{
    const std::vector<std::byte> header = journal_header();
    if (begin.size() <= header.size()) return {};
    const auto differing = [&](std::vector<std::byte> head) {
        return are_equal(begin.first(std::min(begin.size(), head.size())), head) ? std::vector<std::byte>() : head;
    };
    if (const Bytes front = sound_front(begin); !front.empty()) return differing(expected_head(begin, front, false));
    if (const Bytes front = sound_repetition(begin); !front.empty())
        return differing(expected_head(begin, front, true));
    const bool is_like_header = bits_between(begin.first(MAGIC_BYTES), header) <= MAX_DAMAGED_BITS;
    if (!is_like_header || is_newer(begin)) return {};
    // There is no sound repetition: the journal is of an older version, or the repetition is damaged, too. Then the
    // header is replaced by the known one and checked against the first record.
    std::vector<std::byte> front(begin.begin(), begin.end());
    std::ranges::copy(header, front.begin());
    if (const Bytes sound = sound_front(front); !sound.empty()) return differing(expected_head(front, sound, false));
    if (!are_equal(begin.first(header.size()), header) || place_of_repetition(begin)) refuse(path);
    return {};
}

}  // namespace shvr

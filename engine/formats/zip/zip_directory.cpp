#include "engine/formats/zip/zip_directory.h"

#include <algorithm>
#include <cstring>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr {
namespace {

constexpr uint64_t END_BYTES = 22;      ///< size of the end record, without the archive's comment
constexpr uint64_t LOCATOR_BYTES = 20;  ///< size of zip64's locator, which lies right before the end record
constexpr uint64_t END64_BYTES = 56;    ///< size of zip64's end record, without extensions
constexpr uint64_t ENTRY_BYTES = 46;    ///< size of an entry, without name, extra fields and comment
constexpr uint64_t MAX_COMMENT = 65535;
/// Enough for ten million entries.
constexpr uint64_t MAX_DIRECTORY = uint64_t{1} << 30;

constexpr uint32_t END_MARK = 0x06054b50, LOCATOR_MARK = 0x07064b50, END64_MARK = 0x06064b50, ENTRY_MARK = 0x02014b50;
constexpr uint16_t ZIP64_FIELD = 1;
constexpr uint32_t IN_ZIP64 = 0xffffffff;

/// Where the directory is.
struct End {
    uint64_t at = 0;  ///< offset of the first end record, an upper bound for the directory's end
    uint64_t entries = 0, bytes = 0, offset = 0;
};

[[noreturn]] void refuse(const std::string& path, const std::string& what)
{
    fail(path, ": ", what, "; expected a complete zip archive");
}

std::vector<char> read(const ReadAt& read_at, uint64_t offset, size_t count)
{
    std::vector<char> bytes(count);
    read_at(offset, std::as_writable_bytes(std::span(bytes)));
    return bytes;
}

void check_parts(const std::string& path, bool is_one_part)
{
    if (!is_one_part) fail(path, ": is one part of a multi-part archive; expected a single file: join the parts first");
}

/// Takes the values of zip64's end record if a locator right before the end record, at `end.at`, points to one.
void take_zip64(const std::string& path, const ReadAt& read_at, End& end)
{
    if (end.at < LOCATOR_BYTES) return;
    const std::vector<char> locator = read(read_at, end.at - LOCATOR_BYTES, LOCATOR_BYTES);
    if (little_endian<uint32_t>(locator.data()) != LOCATOR_MARK) return;
    const auto at = little_endian<uint64_t>(locator.data() + 8);
    const bool is_inside = at <= end.at - LOCATOR_BYTES && end.at - LOCATOR_BYTES - at >= END64_BYTES;
    if (!is_inside) refuse(path, sentence("its zip64 locator points to byte ", at, ", where no zip64 end record lies"));
    const std::vector<char> record = read(read_at, at, END64_BYTES);
    if (little_endian<uint32_t>(record.data()) != END64_MARK)
        refuse(path, sentence("has no zip64 end record at byte ", at));
    check_parts(path, little_endian<uint32_t>(record.data() + 16) == 0 &&
                          little_endian<uint32_t>(record.data() + 20) == 0 &&
                          little_endian<uint64_t>(record.data() + 24) == little_endian<uint64_t>(record.data() + 32));
    end = {at, little_endian<uint64_t>(record.data() + 32), little_endian<uint64_t>(record.data() + 40),
           little_endian<uint64_t>(record.data() + 48)};
}

/// Finds the last end record whose comment ends exactly at the end of the file.
End find_end(const std::string& path, uint64_t file_bytes, const ReadAt& read_at)
{
    const uint64_t count = std::min(file_bytes, END_BYTES + MAX_COMMENT);
    const std::vector<char> tail = read(read_at, file_bytes - count, count);
    for (uint64_t at = count < END_BYTES ? 0 : count - END_BYTES + 1; at-- > 0;) {
        const char* const record = tail.data() + at;
        if (little_endian<uint32_t>(record) != END_MARK) continue;
        if (at + END_BYTES + little_endian<uint16_t>(record + 20) != count) continue;
        End end{file_bytes - count + at, little_endian<uint16_t>(record + 10), little_endian<uint32_t>(record + 12),
                little_endian<uint32_t>(record + 16)};
        check_parts(path, little_endian<uint16_t>(record + 4) == 0 && little_endian<uint16_t>(record + 6) == 0 &&
                              little_endian<uint16_t>(record + 8) == end.entries);
        take_zip64(path, read_at, end);
        return end;
    }
    refuse(path, "has no end record: it is truncated, or not a zip archive");
}

/// Replaces those fields of the entry that are all ones by 64-bit values from the zip64 extra field, in its order.
void take_zip64_sizes(const std::string& path, std::string_view extra, ZipEntry& entry)
{
    const bool wanted[] = {entry.bytes == IN_ZIP64, entry.stored_bytes == IN_ZIP64, entry.header == IN_ZIP64};
    uint64_t* const values[] = {&entry.bytes, &entry.stored_bytes, &entry.header};
    if (std::ranges::count(wanted, true) == 0) return;
    while (extra.size() >= 4) {
        const auto kind = little_endian<uint16_t>(extra.data());
        const size_t length = little_endian<uint16_t>(extra.data() + 2);
        if (length > extra.size() - 4) break;
        std::string_view field = extra.substr(4, length);
        extra.remove_prefix(4 + length);
        if (kind != ZIP64_FIELD) continue;
        for (size_t i = 0; i < 3; ++i) {
            if (!wanted[i]) continue;
            if (field.size() < 8) refuse(path, sentence("entry ", in_quotes(entry.name), " lacks its zip64 sizes"));
            *values[i] = little_endian<uint64_t>(field.data());
            field.remove_prefix(8);
        }
        return;
    }
    // Without a zip64 extra field, a size of all ones is the actual size: 2^32 - 1.
}

std::vector<ZipEntry> entries_of(const std::string& path, const std::vector<char>& bytes, uint64_t count)
{
    std::vector<ZipEntry> entries;
    entries.reserve(size_t(count));  // `count` is bounded by the size of the directory
    std::string_view rest(bytes.data(), bytes.size());
    for (uint64_t number = 0; number < count; ++number) {
        if (rest.size() < ENTRY_BYTES || little_endian<uint32_t>(rest.data()) != ENTRY_MARK)
            refuse(path, sentence("entry ", number + 1, " of its directory is damaged"));
        const char* const at = rest.data();
        const size_t name = little_endian<uint16_t>(at + 28), extra = little_endian<uint16_t>(at + 30);
        const size_t length = ENTRY_BYTES + name + extra + little_endian<uint16_t>(at + 32);
        if (length > rest.size())
            refuse(path, sentence("entry ", number + 1, " of its directory reaches beyond the directory"));
        ZipEntry entry{.name = rest.substr(ENTRY_BYTES, name),
                       .header = little_endian<uint32_t>(at + 42),
                       .stored_bytes = little_endian<uint32_t>(at + 20),
                       .bytes = little_endian<uint32_t>(at + 24),
                       .crc = little_endian<uint32_t>(at + 16),
                       .method = little_endian<uint16_t>(at + 10),
                       .flags = little_endian<uint16_t>(at + 8)};
        take_zip64_sizes(path, rest.substr(ENTRY_BYTES + name, extra), entry);
        entries.push_back(entry);
        rest.remove_prefix(length);
    }
    if (!rest.empty()) refuse(path, sentence("its directory has ", rest.size(), " bytes more than its entries"));
    return entries;
}

}  // namespace

ZipDirectory read_zip_directory(const std::string& path, uint64_t file_bytes, const ReadAt& read_at)
{
    const End end = find_end(path, file_bytes, read_at);
    if (end.offset > end.at || end.bytes > end.at - end.offset) {
        refuse(path, sentence("its end record states a directory of ", end.bytes, " bytes at byte ", end.offset,
                              ", which overlaps the end record or lies behind it"));
    }
    if (end.bytes > MAX_DIRECTORY)
        fail(path, ": has a directory of ", end.bytes, " bytes; expected at most ", MAX_DIRECTORY);
    if (end.entries > end.bytes / ENTRY_BYTES) {
        refuse(path, sentence("states ", end.entries, " entries in a directory of ", end.bytes, " bytes"));
    }
    ZipDirectory directory{.offset = end.offset, .bytes = read(read_at, end.offset, end.bytes)};
    std::vector<ZipEntry>& entries = directory.entries = entries_of(path, directory.bytes, end.entries);
    // Of entries with equal names, the last counts: zarr-python, for one, appends changed attributes, keeping old ones.
    std::ranges::reverse(entries);
    std::ranges::stable_sort(entries, {}, &ZipEntry::name);
    const auto repeated = std::ranges::unique(entries, {}, &ZipEntry::name);
    entries.erase(repeated.begin(), repeated.end());
    return directory;
}

}  // namespace shvr

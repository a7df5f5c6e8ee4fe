#pragma once
// Reads the central directory of a zip archive (PKWARE's APPNOTE 6.3.10, sections 4.3 and 4.5), zip64 included. It is
// untrusted: it must lie in the file, its entries must fill it exactly, and no allocation exceeds what the size of the
// file justifies. For zip_archive.cpp.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/file.h"

namespace shvr {

/// An entry as the directory describes it. Only the structure of the directory has been checked.
struct ZipEntry {
    std::string_view name{};  ///< as stored: with slashes between folders, and without a leading slash
    uint64_t header = 0;      ///< offset of its local header in the archive
    uint64_t stored_bytes = 0;
    uint64_t bytes = 0;  ///< size when decoded
    uint32_t crc = 0;    ///< CRC-32 of the decoded bytes
    uint16_t method = 0;
    uint16_t flags = 0;
};
inline constexpr uint16_t ZIP_STORED = 0, ZIP_DEFLATED = 8;
inline constexpr uint16_t ZIP_ENCRYPTED = 1;  ///< a flag

struct ZipDirectory {
    uint64_t offset = 0;              ///< offset of the directory in the archive; all entries lie before it
    std::vector<char> bytes{};        ///< bytes of the directory; the names refer to them
    std::vector<ZipEntry> entries{};  ///< sorted by name; of entries with the same name, only the last
};

/// Reads `bytes` at `offset` of the archive; fails if that is impossible.
using ReadAt = std::function<void(uint64_t offset, std::span<std::byte> bytes)>;

/// `path` is used in messages. Fails if the archive has several parts, or its end record or directory is damaged.
ZipDirectory read_zip_directory(const std::string& path, uint64_t file_bytes, const ReadAt& read_at);

/// Decodes the integers of zip files.
template <class T>
T little_endian(const char* at)
{
    T value = 0;
    for (size_t i = 0; i < sizeof(T); ++i) value = T(value | T(T(static_cast<unsigned char>(at[i])) << (8 * i)));
    return value;
}

}  // namespace shvr

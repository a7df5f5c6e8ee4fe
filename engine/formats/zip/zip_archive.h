#pragma once
// A zip archive with random access. Its directory is read once, on opening; its entries, stored or deflated, are read
// by name. Archives are untrusted (zip_directory.h). Nothing is ever unpacked into files. Several threads may call it
// concurrently.

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/formats/zip/zip_directory.h"

namespace shvr {

class ZipArchive {
public:
    /// Fails if the file cannot be read or its directory is damaged. The file stays open.
    explicit ZipArchive(std::filesystem::path path);

    const std::filesystem::path& path() const { return path_; }
    /// All entries, sorted by name. The sizes are unverified until the entries are read.
    const std::vector<ZipEntry>& entries() const { return directory_.entries; }
    /// Null if there is none.
    const ZipEntry* find(std::string_view name) const;

    /// Returns the decoded bytes; their size and CRC-32 must be as the directory states. Fails if they are more than
    /// `max_bytes`, or if the entry is encrypted, compressed in another way, damaged, or outside the file.
    std::vector<std::byte> read(const ZipEntry& entry, int64_t max_bytes) const;
    /// Whether the entry is stored uncompressed, so that parts of it can be read.
    static bool is_plain(const ZipEntry& entry);
    /// Reads bytes of a plain entry from `offset` on; the entry must have enough bytes. Its CRC-32 is not checked.
    void read_part(const ZipEntry& entry, int64_t offset, std::span<std::byte> part) const;

private:
    std::string name_of(const ZipEntry& entry) const;
    uint64_t data_of(const ZipEntry& entry) const;
    void read_at(uint64_t offset, std::span<std::byte> bytes) const;

    std::filesystem::path path_;
    FileDescriptor file_;
    ZipDirectory directory_;
};

}  // namespace shvr

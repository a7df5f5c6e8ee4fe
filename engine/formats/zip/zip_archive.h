#pragma once
// A zip archive with random access. Its directory is read once, on opening; its entries, stored or deflated, are
// read by name. Archives are untrusted (zip_directory.h). Nothing is ever unpacked into files. Any thread may call
// these.

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
    /// Returns all entries, sorted by name. Their sizes are verified only when they are read.
    const std::vector<ZipEntry>& entries() const { return directory_.entries; }
    /// Null if there is none.
    const ZipEntry* find(std::string_view name) const;

    /// Returns the decoded bytes. Fails if there are more than `max_bytes`, if their size or CRC-32 differs from the
    /// directory's, or if the entry is encrypted, damaged, outside the file, or compressed by another method.
    std::vector<std::byte> read(const ZipEntry& entry, int64_t max_bytes) const;
    /// Whether the entry is stored without compression, so that parts of it can be read.
    static bool is_plain(const ZipEntry& entry);
    /// Reads bytes of a plain entry from `offset` on, all of which must exist. Does not check the CRC-32.
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

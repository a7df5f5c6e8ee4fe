#pragma once
// A TIFF file and its chain of directories, read without libtiff, because libtiff takes some microseconds per
// directory, and a file may have a million of them. Only finds how many pages there are, which of them are alike, and
// where they start. libtiff (tiff_page.h) reads one page of each kind when the file is opened, and other pages when
// their voxels are read. Nothing changes after construction; any thread may read.

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/file.h"

namespace shvr {

/// Maximum number of pages, equal to the maximum length of a volume's side.
inline constexpr size_t MAX_TIFF_PAGES = size_t{1} << 20;

class TiffFile {
public:
    /// Fails if `path` is not a regular file, cannot be opened or does not begin like a TIFF.
    explicit TiffFile(std::filesystem::path path);

    /// Whether the first bytes are those of a TIFF or BigTIFF.
    static bool begins(std::string_view head);

    const std::filesystem::path& path() const { return path_; }
    int64_t size_bytes() const { return size_bytes_; }
    bool is_big_endian() const { return is_big_endian_; }
    /// Whether offsets have 8 bytes instead of 4, as in BigTIFF.
    bool has_wide_offsets() const { return has_wide_offsets_; }
    uint64_t first_directory() const { return first_directory_; }

    /// Fills all of `bytes`; fails if the file was truncated.
    void read(int64_t offset, std::span<std::byte> bytes) const;
    /// Reads at most the size of `bytes`; returns the number of bytes read.
    size_t read_some(int64_t offset, std::span<std::byte> bytes) const;
    bool holds(uint64_t offset, uint64_t bytes) const;

private:
    std::filesystem::path path_;
    FileDescriptor file_;
    int64_t size_bytes_ = 0;
    bool is_big_endian_ = false;
    bool has_wide_offsets_ = false;
    uint64_t first_directory_ = 0;
};

struct TiffDirectory {
    uint64_t offset = 0;  ///< in the file
    uint32_t kind = 0;    ///< index into TiffDirectories::kinds
};

/// A kind of page: pages with equal values in the fields about size, layout and meaning, compared in their stored form.
struct TiffKind {
    size_t first_page = 0;
    bool is_reduced = false;  ///< whether the page is marked as a smaller copy of another page, or as a mask
    std::string fields{};     ///< stored values of those fields; also comparable between files
};

struct TiffDirectories {
    std::vector<TiffDirectory> pages;
    std::vector<TiffKind> kinds;
    std::vector<std::string> warnings{};  ///< messages about errors that do not affect the pixels
};

/// Fails, naming page and field, if the chain leaves the file, contains a cycle or is longer than `MAX_TIFF_PAGES`, or
/// if the strips of a page do not fit into the file.
TiffDirectories read_directories(const TiffFile& file);

/// Returns the quotient of a rational field of the directory at `offset`, without libtiff's rounding to a float. Null
/// if the field is missing, not finite, or not above 0.
std::optional<double> rational_field(const TiffFile& file, uint64_t offset, uint16_t tag);
/// Whether the directory at `offset` has a field with this tag.
bool has_field(const TiffFile& file, uint64_t offset, uint16_t tag);

}  // namespace shvr

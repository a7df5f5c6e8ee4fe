#pragma once
// The files of a project folder that describe its volume. The folder also holds the image, an OME-Zarr that other
// programs can read. All files can be recomputed from the image, which still opens if one of them is damaged.
//
//   PROJECT/shvr/volume.json      the volume's source, placement in space, statistics, and a hash of its content
//   PROJECT/shvr/ranges-LEVEL     smallest and largest value under every brick
//   PROJECT/shvr/checksums-LEVEL  checksum of every chunk as stored
//   PROJECT/shvr/session.json     the session (engine/session/session.h)
//
// Files with a level are tables with one element per brick or chunk, x fastest: 64 bytes of header, then the elements
// in a zstd frame. Header: "SHVRTAB1", kind (8 bytes), level and bytes of an element (4 each), counts x, y, z (8 each),
// bytes of the frame (8), XXH3-64 of the preceding 56 bytes and the elements (8); little-endian. A sparse table, whose
// kind ends in "/s", lists the elements that differ from a default: first the default, then the numbers of the other
// elements (8 bytes each, ascending), then those elements. Programs without support for sparse tables ignore them with
// a warning. Any thread may call these.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "engine/volume/volume.h"

namespace shvr {

/// The content of volume.json.
struct ProjectRecord {
    VolumeInfo info{};  ///< the volume, without name and format; its warnings are the import's
    int levels = 1;
    VolumeStatistics statistics{};  ///< of level 0
    std::string content_hash{};     ///< of level 0; content_hash.h
    std::string source{};           ///< path of the file that the volume was imported from
    std::string preparation{};      ///< description of the processing applied to the voxels; "": none
    double fill = 0.0;              ///< value of the voxels of chunks that are not stored; may be NaN
};
inline constexpr const char* PROJECT_RECORD = "shvr/volume.json";
inline constexpr const char* PROJECT_SESSION = "shvr/session.json";

std::string to_text(const ProjectRecord& record);
ProjectRecord read_project_record(const std::filesystem::path& file);

struct ProjectTable {
    std::string kind{};  ///< "ranges" or "checksum"
    int level = 0;
    size_t element_bytes = 1;
    Size3 counts{0};
    /// Elements in native byte order. In a sparse table: first the default, for elements without key; then one per key.
    std::vector<std::byte> elements{};
    bool is_sparse = false;
    std::vector<uint64_t> keys{};  ///< numbers of the elements listed in a sparse table, ascending

    /// Returns the element for a brick or chunk by its number, also from a sparse table.
    std::span<const std::byte> at(int64_t number) const;
};
std::filesystem::path ranges_path(const std::filesystem::path& project, int level);
std::filesystem::path checksums_path(const std::filesystem::path& project, int level);

/// Fails, naming the file, if a table with every element would be too large. Meant to be called before the work begins.
void check_tables(const std::filesystem::path& project, const VolumeInfo& info);

/// Whether a sparse table with `listed` elements is smaller than a table with every element.
bool is_smaller_as_list(const ProjectTable& table, size_t listed);
/// Returns a table in the form to store: dense if that is smaller or if `is_small`, sparse otherwise. So equal content
/// has equal bytes, and older versions, which lack sparse tables, can read the tables of volumes they could import.
ProjectTable stored_form(ProjectTable sparse, bool is_small);
std::vector<std::byte> to_bytes(const ProjectTable& table);
/// Reads the table in `file`, dense or sparse. Fails unless kind, level, counts and element size equal `expected`'s.
ProjectTable read_project_table(const std::filesystem::path& file, const ProjectTable& expected);

/// Decodes an element of a ranges table: two voxels, the smallest and the largest finite value. If no value is finite,
/// the first is larger than the second.
ValueRange range_of(VoxelType type, std::span<const std::byte> element);

}  // namespace shvr

#pragma once
// The files of a project folder that describe its volume, in addition to the image, which is an OME-Zarr that other
// programs can read. All of them can be recomputed from the image, which still opens if one of these files is damaged.
//
//   PROJECT/shvr/volume.json      where the volume came from, how it lies in space, statistics, a hash of its content
//   PROJECT/shvr/ranges-LEVEL     smallest and largest value under every brick
//   PROJECT/shvr/checksums-LEVEL  checksum of every chunk as stored
//   PROJECT/shvr/session.json     engine/session/session.h
//
// Files with a level are tables with one element per brick or chunk, x fastest; 64 bytes of header, then the elements
// in a zstd frame. Header: "SHVRTAB1", kind (8 bytes), level and bytes of an element (4 each), counts x, y, z (8 each),
// bytes of the frame (8), XXH3-64 of the 56 bytes before and the elements (8); little-endian. A sparse table, whose
// kind ends in "/s", lists what differs from one element: that element, then the numbers of the others (8 bytes each,
// ascending), then the others. Programs that know no sparse tables ignore them with a warning. Any thread may call
// these.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "engine/volume/volume.h"

namespace shvr {

/// The content of volume.json.
struct ProjectRecord {
    VolumeInfo info{};  ///< the volume, without name and format; its warnings are those of the import
    int levels = 1;
    VolumeStatistics statistics{};  ///< of level 0
    std::string content_hash{};     ///< of level 0; content_hash.h
    std::string source{};           ///< path of the file it was imported from
    std::string preparation{};      ///< description of the processing applied to the voxels; empty: none
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
    /// Native byte order. A sparse table has the element of all that have no key, then one for each key.
    std::vector<std::byte> elements{};
    bool is_sparse = false;
    std::vector<uint64_t> keys{};  ///< numbers of a sparse table's elements, ascending

    /// The element of a brick or chunk, by its number.
    std::span<const std::byte> at(int64_t number) const;
};
std::filesystem::path ranges_path(const std::filesystem::path& project, int level);
std::filesystem::path checksums_path(const std::filesystem::path& project, int level);

/// Fails if a table of such a volume would be too large, unless it is sparse, naming its file: call it before the work.
void check_tables(const std::filesystem::path& project, const VolumeInfo& info);

/// Whether a table that lists this many elements is smaller than one with every element.
bool is_smaller_as_list(const ProjectTable& table, size_t listed);
/// A sparse table in the form in which it is stored: with every element, if that is smaller or if `is_small`. So equal
/// content has equal bytes, and older programs read the tables of all volumes that they could import.
ProjectTable stored_form(ProjectTable sparse, bool is_small);
std::vector<std::byte> to_bytes(const ProjectTable& table);
/// The table in `file`, sparse or not, which must have the kind, level, counts and element size of `expected`.
ProjectTable read_project_table(const std::filesystem::path& file, const ProjectTable& expected);

/// An element of ranges-LEVEL is two voxels: the smallest and the largest finite value; the first is larger if there is
/// none.
ValueRange range_of(VoxelType type, std::span<const std::byte> element);

}  // namespace shvr

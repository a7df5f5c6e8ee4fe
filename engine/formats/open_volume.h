#pragma once
// Opens a volume file by trying each reader in turn.

#include <string>
#include <string_view>

#include "engine/volume/source.h"

namespace shvr {

/// Layout of a raw file without a side-car, in the user's form "256x256x108:int16[:big|little][:OFFSET]".
struct RawLayout {
    Size3 size{0};
    VoxelType type = VoxelType::uint8;
    std::optional<bool> big_endian{};  ///< null: little-endian is assumed, with a warning
    int64_t offset_bytes = 0;
    glm::dvec3 spacing{1.0};
    std::string unit = "voxel";
    bool operator==(const RawLayout&) const = default;
};
/// Fails with a `UsageError` that shows the form above.
RawLayout parse_raw_layout(const std::string& text);

/// The end of the error message for an address where only a local path is accepted.
inline constexpr const char* NO_ADDRESS =
    "the path of a file or folder on this machine, since only volumes are read over a network";

/// Whether `path`, judged by its name, is a zipped OME-Zarr (.ozx, .zip) or a path inside one. A path inside an
/// archive, such as scan.ozx/0, does not exist in the file system. Reads nothing.
bool leads_into_archive(const std::filesystem::path& path);
/// For a project that was zipped as a whole or lies behind an address, returns a message that only its image is read;
/// otherwise, an empty text. Reads the archive's directory, or asks the server.
std::string archived_project(const std::filesystem::path& path);

/// Returns the name of the format that a file name implies, such as "NIfTI" for scan.nii.gz; empty if none. The file
/// may be in another format all the same, and some formats have no extension of their own. Reads nothing.
std::string_view format_of_name(std::string_view name);
inline bool is_volume_name(std::string_view name)
{
    return !format_of_name(name).empty();
}

/// Whether files with such a name, gzipped or not, state the size of their volume; raw voxels do not. Reads nothing.
bool name_states_size(std::string_view name);
/// Returns the formats whose files state the volume's size: "OME-Zarr, TIFF, ... and JPEG" (`conjunction`: "and").
std::string format_names(std::string_view conjunction);

/// Fails if no reader recognises the file (the message lists the formats tried), or if a reader finds it damaged.
std::unique_ptr<VolumeSource> open_volume(const std::filesystem::path& path, const OpenOptions& options = {});
/// Opens raw voxels. `path` is one file, the first of numbered files with one slice each ("head.1", "slice007.raw"), or
/// a folder of such files, sorted by the numbers in their names. OFFSET bytes are skipped in each file.
std::unique_ptr<VolumeSource> open_raw(const std::filesystem::path& path, const RawLayout& layout);

}  // namespace shvr

#pragma once
// Opens a volume file by asking each reader in turn.

#include <string_view>

#include "engine/volume/source.h"

namespace shvr {

/// How to read a file of bare voxels when no side-car says so: "256x256x108:int16[:big|little][:OFFSET]".
struct RawLayout {
    Size3 size{0};
    VoxelType type = VoxelType::uint8;
    std::optional<bool> big_endian{};  ///< nothing: little-endian is taken, with a warning
    int64_t offset_bytes = 0;
    glm::dvec3 spacing{1.0};
    std::string unit = "voxel";
    bool operator==(const RawLayout&) const = default;
};
/// Fails with a `UsageError` that shows the expected form.
RawLayout parse_raw_layout(const std::string& text);

/// Whether it is no path but an address, as in https://host/scan.zarr or s3://bucket/scan.zarr. Nothing is read over a
/// network.
bool is_address(std::string_view path);
inline constexpr const char* NO_ADDRESS =
    "the path of a file or folder on this machine, since nothing is read over a network: copy it here, or mount it";

/// Fails where no reader knows the file (naming the formats tried), or where the reader that knows it finds it broken.
std::unique_ptr<VolumeSource> open_volume(const std::filesystem::path& path, const OpenOptions& options = {});
/// `path` is one file; or the first of numbered files ("head.1", "slice007.raw") that hold one slice each; or a folder
/// of such files, in the order of the numbers in their names. OFFSET is left out of each.
std::unique_ptr<VolumeSource> open_raw(const std::filesystem::path& path, const RawLayout& layout);

}  // namespace shvr

#pragma once
// The attributes of OME-Zarr images (https://ngff.openmicroscopy.org, versions 0.1 to 0.5), in a form common to all
// versions. For source_ome_zarr.cpp. Any thread may call these functions.

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "engine/base/spelling.h"
#include "engine/formats/zarr/store/zarr_node.h"

namespace shvr {

/// The versions that this program can write: 0.4 uses Zarr version 2, 0.5 uses Zarr version 3.
enum class OmeZarrVersion { v0_4, v0_5 };
inline constexpr Spelling<OmeZarrVersion> OME_ZARR_VERSIONS[] = {{OmeZarrVersion::v0_4, "0.4"},
                                                                 {OmeZarrVersion::v0_5, "0.5"}};
constexpr std::span<const Spelling<OmeZarrVersion>> spellings_of(OmeZarrVersion)
{
    return OME_ZARR_VERSIONS;
}

struct OmeImage {
    /// One resolution level; the finest comes first.
    struct Level {
        std::string path;                         ///< path of its array, relative to the image's folder
        std::optional<glm::dvec3> scale{};        ///< x, y, z: size of a voxel in `unit`
        std::optional<glm::dvec3> translation{};  ///< x, y, z: the centre of voxel 0, if stated
    };
    size_t axes = 0;                    ///< the number of axes that every array must have
    std::vector<std::string> names{};   ///< names of the axes
    std::array<size_t, 3> xyz{};        ///< the array's axes that are x, y and z
    std::optional<size_t> channel{};    ///< the array's axis of channels, if any
    std::optional<size_t> time{};       ///< the array's axis of time points, if any
    std::optional<std::string> unit{};  ///< unit of x, y and z
    std::vector<Level> levels{};
    std::vector<std::string> channels{};  ///< names of the channels, if the file states any
    std::vector<std::string> warnings{};
};

/// Reads the image's attributes from the node's `ome()`, which must have "multiscales". Fails if they violate the
/// specification, describe no z axis, or are of an unsupported version.
OmeImage read_ome_image(const ZarrNode& node);
/// For Zarr 3 nodes: fails if "ome" states a version other than 0.5, or if "multiscales" stands outside of "ome".
void check_ome_version(const ZarrNode& node);

/// Reads the path of a group or an array, relative to the node with these attributes. Fails if the path leads out of
/// that node, by mistake or as an attack.
std::string read_zarr_path(const JsonNode& node);

/// Returns the specification's name of a unit ("um": "micrometer"), or an unknown unit unchanged.
std::string ome_unit(const std::string& unit);

}  // namespace shvr

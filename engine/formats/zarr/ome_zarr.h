#pragma once
// The attributes of an OME-Zarr image (https://ngff.openmicroscopy.org, versions 0.1 to 0.5), in one common form. For
// source_ome_zarr.cpp. Any thread may call it.

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "engine/base/spelling.h"
#include "engine/formats/zarr/store/zarr_node.h"

namespace shvr {

/// The versions that are written: 0.4 has Zarr version 2, 0.5 has Zarr version 3.
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
        std::optional<glm::dvec3> scale{};        ///< x, y, z: unit per voxel
        std::optional<glm::dvec3> translation{};  ///< x, y, z: the centre of voxel 0, if stated
    };
    size_t axes = 0;                    ///< the number of axes that every array must have
    std::vector<std::string> names{};   ///< names of the axes
    std::array<size_t, 3> xyz{};        ///< index of the array's axis along x, y and z
    std::optional<size_t> channel{};    ///< the array's axis of channels
    std::optional<size_t> time{};       ///< the array's axis of time points
    std::optional<std::string> unit{};  ///< unit of x, y and z
    std::vector<Level> levels{};
    std::vector<std::string> channels{};  ///< names of the channels, if the file states any
    std::vector<std::string> warnings{};
};

/// The node's `ome()` has a "multiscales". Fails if it violates the specification, has no z axis, or is of another
/// version.
OmeImage read_ome_image(const ZarrNode& node);
/// Fails if a Zarr version 3 node has an "ome" object whose version is not 0.5, or "multiscales" without that object.
void check_ome_version(const ZarrNode& node);

/// Reads the path of a group or an array relative to the node with these attributes. Fails if the path leaves that
/// node: an attack or a mistake.
std::string read_zarr_path(const JsonNode& node);

/// The specification's name of a unit ("um": "micrometer"); other units unchanged.
std::string ome_unit(const std::string& unit);

}  // namespace shvr

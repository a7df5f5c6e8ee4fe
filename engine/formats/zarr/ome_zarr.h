#pragma once
// The attributes of an OME-Zarr image (https://ngff.openmicroscopy.org, versions 0.1 to 0.4), in one common form. For
// source_ome_zarr.cpp. Any thread may call it.

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "engine/base/json.h"

namespace shvr {

struct OmeImage {
    /// One resolution level; the finest comes first.
    struct Level {
        std::string path;                         ///< of its array, relative to the image's folder
        std::optional<glm::dvec3> scale{};        ///< x, y, z: unit per voxel
        std::optional<glm::dvec3> translation{};  ///< x, y, z: the centre of voxel 0, if stated
    };
    size_t axes = 0;                    ///< the number of axes that every array must have
    std::array<size_t, 3> xyz{};        ///< the array's axis along x, y and z
    std::optional<size_t> channel{};    ///< the array's axis of channels
    std::optional<size_t> time{};       ///< the array's axis of points in time
    std::optional<std::string> unit{};  ///< unit of x, y and z
    std::vector<Level> levels{};
    std::vector<std::string> channels{};  ///< channel names, as far as there are any
    std::vector<std::string> warnings{};
};

/// `attributes` is the content of `path`, a .zattrs, and has a "multiscales". Fails if it violates the specification,
/// or has no z axis.
OmeImage read_ome_image(const std::filesystem::path& path, const JsonNode& attributes);

/// The specification's name of a unit ("um": "micrometer"); other units unchanged.
std::string ome_unit(const std::string& unit);

}  // namespace shvr

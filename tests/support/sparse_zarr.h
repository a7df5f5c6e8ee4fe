#pragma once
// Sparse OME-Zarr images of uint8, of which only some chunks exist.

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "engine/base/error.h"
#include "engine/volume/volume.h"

namespace shvr::test {

struct SparseZarr {
    Size3 size{64};
    Size3 chunk{16};
    int levels = 1;
    char separator = '/';
    int fill = 0;
};

/// The voxel of a level that stands in a chunk, by its position in that level.
using VoxelOf = std::function<uint8_t(int level, const Size3& voxel)>;

/// Writes the folder with the given chunks of each level.
inline void write_sparse(const std::filesystem::path& folder, const SparseZarr& image,
                         const std::function<std::vector<Size3>(int level)>& chunks, const VoxelOf& voxel_of)
{
    std::filesystem::create_directories(folder);
    std::string datasets;
    for (int level = 0; level < image.levels; ++level) {
        const double scale = double(int64_t{1} << level), shift = 0.5 * (scale - 1.0);
        datasets +=
            sentence(level > 0 ? "," : "", R"({"path":")", level,
                     R"(","coordinateTransformations":[{"type":"scale","scale":[)", scale, ",", scale, ",", scale,
                     R"(]},{"type":"translation","translation":[)", shift, ",", shift, ",", shift, "]}]}");
        const std::filesystem::path array = folder / std::to_string(level);
        std::filesystem::create_directories(array);
        const Size3 size = (image.size + ((int64_t{1} << level) - 1)) / (int64_t{1} << level);
        std::ofstream(array / ".zarray") << R"({"zarr_format":2,"shape":[)" << size.z << "," << size.y << "," << size.x
                                         << R"(],"chunks":[)" << image.chunk.z << "," << image.chunk.y << ","
                                         << image.chunk.x << R"(],"dtype":"|u1","compressor":null,"fill_value":)"
                                         << image.fill << R"(,"order":"C","filters":null,"dimension_separator":")"
                                         << image.separator << "\"}";
        for (const Size3& chunk : chunks(level)) {
            const std::filesystem::path file =
                array / sentence(chunk.z, image.separator, chunk.y, image.separator, chunk.x);
            std::filesystem::create_directories(file.parent_path());
            std::string voxels;
            for (int64_t z = 0; z < image.chunk.z; ++z)
                for (int64_t y = 0; y < image.chunk.y; ++y)
                    for (int64_t x = 0; x < image.chunk.x; ++x)
                        voxels += char(voxel_of(level, chunk * image.chunk + Size3(x, y, z)));
            std::ofstream(file, std::ios::binary) << voxels;
        }
    }
    std::ofstream(folder / ".zgroup") << R"({"zarr_format":2})";
    std::ofstream(folder / ".zattrs")
        << R"({"multiscales":[{"version":"0.4","axes":[{"name":"z","type":"space"},{"name":"y","type":"space"},)"
        << R"({"name":"x","type":"space"}],"datasets":[)" << datasets << "]}]}";
}

/// A number that looks random, equal on every machine.
inline uint32_t scrambled(uint32_t number)
{
    number = (number ^ 61) ^ (number >> 16);
    number *= 9;
    number ^= number >> 4;
    number *= 0x27d4eb2d;
    return number ^ (number >> 15);
}

}  // namespace shvr::test

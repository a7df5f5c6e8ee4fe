#include "engine/live/relevance_host.h"

#include <cmath>

#include "engine/volume/voxel_numbers.h"

namespace shvr {

VoxelBox relevance_cube(const glm::dvec3& voxel, const Size3& volume_size, int64_t side)
{
    for (int axis = 0; axis < 3; ++axis)
        if (!std::isfinite(voxel[axis])) fail("the probe's place along ", "xyz"[axis], " is ", voxel[axis]);
    const Size3 size = glm::min(volume_size, Size3(side));
    const glm::dvec3 lower =
        glm::clamp(glm::round(voxel - 0.5 * glm::dvec3(size)), glm::dvec3(0.0), glm::dvec3(volume_size - size));
    return {Size3(lower), Size3(lower) + size};
}

RelevanceBits relevance_on_host(const VolumeSource& source, int level, const VoxelBox& box, double threshold)
{
    const Size3 size = box.size();
    std::vector<double> values(size_t(size.x * size.y * size.z));
    std::vector<std::byte> bytes(values.size() * bytes_of(source.info().type));
    source.read_level(level, box, bytes);
    load_voxels(source.info().type, bytes.data(), values);
    RelevanceBits bits{.box = box, .words_per_row = (size.x + 31) / 32};
    bits.words.assign(size_t(bits.words_per_row * size.y * size.z), 0u);
    for (int64_t row = 0; row < size.y * size.z; ++row)
        for (int64_t x = 0; x < size.x; ++x)
            if (values[size_t(row * size.x + x)] >= threshold)
                bits.words[size_t(row * bits.words_per_row + x / 32)] |= 1u << (x % 32);
    return bits;
}

}  // namespace shvr

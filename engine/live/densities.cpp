#include "engine/live/densities.h"

#include "engine/volume/voxel_numbers.h"

namespace shvr {

DensityBox densities_in(const VolumeSource& source, const DensityField& offsets, const VoxelBox& box)
{
    const Size3 size = box.size();
    DensityBox densities{.lower = glm::ivec3(box.lower), .size = glm::ivec3(size), .values = {}};
    densities.values.resize(size_t(size.x * size.y * size.z));
    std::vector<std::byte> bytes(densities.values.size() * bytes_of(source.info().type));
    source.read(box, bytes);
    load_voxels(source.info().type, bytes.data(), densities.values);
    add_offsets(offsets, box, densities);
    return densities;
}

void add_offsets(const DensityField& offsets, const VoxelBox& box, DensityBox& densities)
{
    const Size3 size = box.size();
    if (offsets.voxels() == 0) return;
    for (size_t i = 0; i < densities.values.size(); ++i) {
        const auto at = int64_t(i);
        densities.values[i] += offsets.at(box.lower + Size3(at % size.x, at / size.x % size.y, at / (size.x * size.y)));
    }
}

}  // namespace shvr

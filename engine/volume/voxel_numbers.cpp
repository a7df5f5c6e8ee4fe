#include "engine/volume/voxel_numbers.h"

#include <cstring>
#include <type_traits>

#include "engine/volume/voxel_dispatch.h"

namespace shvr {
namespace {

template <class T>
T to_voxel(double value)
{
    if constexpr (std::is_floating_point_v<T>) return static_cast<T>(value);
    // A floor without std::floor, which is a function call on processors without SSE 4.1.
    const double raised = value + 0.5;
    const auto whole = int64_t(raised);
    return static_cast<T>(double(whole) > raised ? whole - 1 : whole);
}

}  // namespace

void load_voxels(VoxelType type, const std::byte* voxels, std::span<double> values)
{
    with_voxel_type(type, [&]<class T>(T voxel) {
        for (size_t i = 0; i < values.size(); ++i) {
            std::memcpy(&voxel, voxels + i * sizeof(T), sizeof(T));
            values[i] = double(voxel);
        }
    });
}

void store_voxels(VoxelType type, std::span<const double> values, std::byte* voxels)
{
    with_voxel_type(type, [&]<class T>(T voxel) {
        for (size_t i = 0; i < values.size(); ++i) {
            voxel = to_voxel<T>(values[i]);
            std::memcpy(voxels + i * sizeof(T), &voxel, sizeof(T));
        }
    });
}

}  // namespace shvr

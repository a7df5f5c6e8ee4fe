#pragma once
// Calls a generic function with a voxel of the C++ type for a VoxelType:
//
//     with_voxel_type(info.type, [&]<class T>(T) { work_on<T>(voxels); });

#include <utility>

#include "engine/volume/volume.h"

namespace shvr {

template <class Function>
decltype(auto) with_voxel_type(VoxelType type, Function&& function)
{
    switch (type) {
        case VoxelType::uint8: break;
        case VoxelType::int8: return std::forward<Function>(function)(int8_t{});
        case VoxelType::uint16: return std::forward<Function>(function)(uint16_t{});
        case VoxelType::int16: return std::forward<Function>(function)(int16_t{});
        case VoxelType::uint32: return std::forward<Function>(function)(uint32_t{});
        case VoxelType::int32: return std::forward<Function>(function)(int32_t{});
        case VoxelType::float32: return std::forward<Function>(function)(float{});
        case VoxelType::float64: return std::forward<Function>(function)(double{});
    }
    return std::forward<Function>(function)(uint8_t{});
}

}  // namespace shvr

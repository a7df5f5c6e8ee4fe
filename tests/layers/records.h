#pragma once
// Limits and memory tables of real devices, in round numbers, as their drivers report them (vulkan.gpuinfo.org), and of
// the minimum that is worth running on. Plain values.

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include <vulkan/vulkan.h>

namespace layers {

struct Record {
    std::string_view name;  ///< as the environment asks for it
    const char* device;
    VkPhysicalDeviceType type;
    uint32_t max_side_3d, max_side_2d;
    uint64_t max_allocation, max_image, max_buffer;  ///< bytes
    uint32_t max_storage_range;                      ///< bytes
    uint32_t max_allocations;
    bool linear_r16;
    uint32_t timestamp_bits;
    float timestamp_period;
    bool tells_budget;  ///< VK_EXT_memory_budget: nine tenths of each heap, less what is allocated
    std::vector<VkMemoryHeap> heaps;
    std::vector<VkMemoryType> types;
    bool tells_faults = false;               ///< VK_EXT_device_fault
    bool has_memory_priority = false;        ///< VK_EXT_memory_priority
    uint32_t max_storage_images = 1u << 20;  ///< per kernel
};

inline constexpr VkMemoryPropertyFlags LOCAL = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
inline constexpr VkMemoryPropertyFlags MAPPED =
    VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
inline constexpr VkMemoryPropertyFlags CACHED = MAPPED | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
inline constexpr VkMemoryPropertyFlags UNCACHED =
    VK_MEMORY_PROPERTY_DEVICE_COHERENT_BIT_AMD | VK_MEMORY_PROPERTY_DEVICE_UNCACHED_BIT_AMD;
inline constexpr uint64_t MEBI = uint64_t{1} << 20, GIBI = uint64_t{1} << 30;

inline std::vector<Record> made_records()
{
    std::vector<Record> all{
        {.name = "nvidia",
         .device = "record of a discrete NVIDIA",
         .type = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU,
         .max_side_3d = 16384,
         .max_side_2d = 32768,
         .max_allocation = 0xffe00000,
         .max_image = 0xffe00000,
         .max_buffer = 0xffe00000,
         .max_storage_range = 0xffffffff,
         .max_allocations = 4096,
         .linear_r16 = true,
         .timestamp_bits = 64,
         .timestamp_period = 1.0f,
         .tells_budget = true,
         .heaps = {{12 * GIBI, VK_MEMORY_HEAP_DEVICE_LOCAL_BIT}, {24 * GIBI, 0}, {214 * MEBI, 1}},
         .types = {{0, 1}, {LOCAL, 0}, {MAPPED, 1}, {CACHED, 1}, {LOCAL | MAPPED, 2}},
         .tells_faults = true,
         .has_memory_priority = true},
        {.name = "amd",
         .device = "record of a discrete AMD",
         .type = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU,
         .max_side_3d = 2048,
         .max_side_2d = 16384,
         .max_allocation = 2 * GIBI,
         .max_image = 2 * GIBI,
         .max_buffer = 2 * GIBI,
         .max_storage_range = 0xffffffff,
         .max_allocations = 4096,
         .linear_r16 = true,
         .timestamp_bits = 64,
         .timestamp_period = 10.0f,
         .tells_budget = true,
         .heaps = {{8 * GIBI, VK_MEMORY_HEAP_DEVICE_LOCAL_BIT}, {256 * MEBI, 1}, {16 * GIBI, 0}},
         .types = {{LOCAL | MAPPED | UNCACHED, 0},
                   {LOCAL, 0},
                   {MAPPED, 2},
                   {LOCAL | MAPPED, 1},
                   {CACHED, 2},
                   {CACHED | UNCACHED, 2}},
         .has_memory_priority = true},
        {.name = "apu",
         .device = "record of an AMD APU",
         .type = VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU,
         .max_side_3d = 2048,
         .max_side_2d = 16384,
         .max_allocation = 2 * GIBI,
         .max_image = 2 * GIBI,
         .max_buffer = 2 * GIBI,
         .max_storage_range = 0xffffffff,
         .max_allocations = 4096,
         .linear_r16 = true,
         .timestamp_bits = 64,
         .timestamp_period = 10.0f,
         .tells_budget = true,
         .heaps = {{8 * MEBI, VK_MEMORY_HEAP_DEVICE_LOCAL_BIT}, {7 * GIBI, 0}},
         .types = {{LOCAL, 0}, {LOCAL | MAPPED, 0}, {MAPPED, 1}, {CACHED, 1}}},
        {.name = "intel",
         .device = "record of an Intel integrated GPU",
         .type = VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU,
         .max_side_3d = 2048,
         .max_side_2d = 16384,
         .max_allocation = 2 * GIBI,
         .max_image = 2 * GIBI,
         .max_buffer = 1 * GIBI,
         .max_storage_range = 1u << 30,
         .max_allocations = 4096,
         .linear_r16 = true,
         .timestamp_bits = 36,
         .timestamp_period = 83.333f,
         .tells_budget = true,
         .heaps = {{12 * GIBI, VK_MEMORY_HEAP_DEVICE_LOCAL_BIT}},
         .types = {{LOCAL | MAPPED, 0}, {LOCAL | CACHED, 0}}},
        {.name = "minimum",
         .device = "record of the least device",
         .type = VK_PHYSICAL_DEVICE_TYPE_OTHER,
         .max_side_3d = 256,
         .max_side_2d = 4096,
         .max_allocation = 64 * MEBI,
         .max_image = 64 * MEBI,
         .max_buffer = 64 * MEBI,
         .max_storage_range = 1u << 27,
         .max_allocations = 64,
         .linear_r16 = false,
         .timestamp_bits = 0,
         .timestamp_period = 1.0f,
         .tells_budget = false,
         .heaps = {{192 * MEBI, VK_MEMORY_HEAP_DEVICE_LOCAL_BIT}, {256 * MEBI, 0}},
         .types = {{LOCAL, 0}, {MAPPED, 1}}},
    };
    const Record least = all.back();
    Record filters = least;
    filters.name = "filters";
    filters.device = "record of the least device, with samplers, large sides and small images";
    filters.linear_r16 = true;
    filters.max_side_3d = 2048;
    filters.max_image = 24 * MEBI;
    all.push_back(filters);
    Record pieces = filters;
    pieces.name = "pieces";
    pieces.device = "record of a device whose images hold little";
    pieces.max_image = 8 * MEBI;
    all.push_back(pieces);
    Record bare = least;  // the minimum, with fewer images than a kernel binds
    bare.name = "bare";
    bare.device = "record of a device with too few images";
    bare.max_storage_images = 4;
    all.push_back(bare);
    return all;
}

inline const std::vector<Record>& records()
{
    static const std::vector<Record> all = made_records();
    return all;
}

}  // namespace layers

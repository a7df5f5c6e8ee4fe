#pragma once
// What the kernels need of a device beyond what Vulkan 1.3 promises, which some devices might not have. A test compares
// it with the kernels (tests/unit/device/device_needs_test.cpp). Any thread.

#include <cstdint>
#include <optional>
#include <string>

#include <vulkan/vulkan.h>

namespace shvr::gpu {

/// The most that one kernel binds, or holds.
inline constexpr uint32_t MAX_STORAGE_IMAGES = 11, MAX_STORAGE_BUFFERS = 6, MAX_SAMPLED_IMAGES = 1;
inline constexpr uint32_t MAX_PUSH_BYTES = 128, MAX_GROUP_THREADS = 128;

/// Why a device with these limits cannot run the kernels, in words: what it has and what is expected; null: it can.
std::optional<std::string> why_too_limited(const VkPhysicalDeviceLimits& limits);

}  // namespace shvr::gpu

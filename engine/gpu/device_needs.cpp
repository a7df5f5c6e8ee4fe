#include "engine/gpu/device_needs.h"

#include <cstdio>

#include <sys/resource.h>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr::gpu {

std::vector<Need> needs_of(const DeviceHas& has)
{
    const VkPhysicalDeviceLimits& limits = has.limits;
    return {{"storage images in a kernel", limits.maxPerStageDescriptorStorageImages, MAX_STORAGE_IMAGES},
            {"storage buffers in a kernel", limits.maxPerStageDescriptorStorageBuffers, MAX_STORAGE_BUFFERS},
            {"sampled images in a kernel", limits.maxPerStageDescriptorSampledImages, MAX_SAMPLED_IMAGES},
            {"resources in a kernel", limits.maxPerStageResources,
             MAX_STORAGE_IMAGES + MAX_STORAGE_BUFFERS + MAX_SAMPLED_IMAGES},
            {"bytes of push constants", limits.maxPushConstantsSize, MAX_PUSH_BYTES},
            {"threads in a group", limits.maxComputeWorkGroupInvocations, MAX_GROUP_THREADS},
            {"bytes that a group shares", limits.maxComputeSharedMemorySize, MAX_SHARED_BYTES},
            {"bytes in a storage buffer", limits.maxStorageBufferRange, MIN_BUFFER_BYTES},
            {"bytes in a buffer", has.max_buffer_bytes, MIN_BUFFER_BYTES}};
}

std::optional<std::string> why_too_limited(const DeviceHas& has)
{
    for (const Need& need : needs_of(has))
        if (need.has < need.needed)
            return sentence("it allows ", need.has, " ", need.what, "; expected at least ", need.needed);
    constexpr VkFormatFeatureFlags STORED =
        VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT | VK_FORMAT_FEATURE_TRANSFER_SRC_BIT | VK_FORMAT_FEATURE_TRANSFER_DST_BIT;
    if ((has.r8_uint & STORED) != STORED)
        return "R8_UINT storage images cannot be read and written; expected a driver that can do so";
    if ((has.r32_uint & STORED) != STORED)
        return "R32_UINT storage images cannot be read and written; expected a driver that can do so";
    return std::nullopt;
}

namespace {

/// Returns a device's rank: hardware devices before software, discrete before integrated.
int rank(VkPhysicalDeviceType type)
{
    switch (type) {
        case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU: return 0;
        case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU: return 1;
        case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU: return 2;
        default: return 3;
    }
}

}  // namespace

bool keeps_atlas_in_buffer(const char* named, VkDriverId driver, const std::string& info)
{
    const std::string home = named ? named : "";
    if (!home.empty() && home != "image" && home != "buffer")
        fail("SHVR_ATLAS is '", home, "'; expected image or buffer");
    if (!home.empty()) return home == "buffer";
    int major = 0, minor = 0;
    if (driver != VK_DRIVER_ID_MESA_LLVMPIPE || std::sscanf(info.c_str(), "Mesa %d.%d", &major, &minor) != 2)
        return false;
    return major > 23 || (major == 23 && minor >= 3);
}

std::string no_driver_in_words()
{
    const char* const words =
        "no Vulkan device found; expected a GPU driver, or the package mesa-vulkan-drivers (lavapipe)";
    rlimit limit{};
    if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return words;
    return sentence(words, ", or more memory for drivers than the limit of ", limit.rlim_cur >> 20, " MiB (ulimit -v)");
}

std::string why_unfit(const DeviceRow& row)
{
    if (!row.has_1_3) return "it does not support Vulkan 1.3";
    return row.computes ? row.lacks : "it does not compute";
}

size_t best_device(const std::vector<DeviceRow>& rows, const std::string& wanted, const std::string& wanted_by)
{
    if (rows.empty()) fail(no_driver_in_words());
    const bool by_index = !wanted.empty() && wanted.find_first_not_of("0123456789") == std::string::npos;
    std::optional<size_t> best, unseen, unfit;
    std::string names;
    for (size_t i = 0; i < rows.size(); ++i) {
        const DeviceRow& row = rows[i];
        const std::string why = why_unfit(row);
        names += sentence(names.empty() ? "" : ", ", i, ": ", row.name, why.empty() ? "" : " (" + why + ")");
        const bool is_meant =
            by_index ? std::to_string(i) == wanted : lower_case(row.name).find(lower_case(wanted)) != std::string::npos;
        if (!is_meant) continue;
        std::optional<size_t>& of_its_kind = !why.empty() ? unfit : row.presents ? best : unseen;
        if (!of_its_kind || rank(row.type) < rank(rows[*of_its_kind].type)) of_its_kind = i;
    }
    if (best) return *best;
    if (unseen)
        fail("device ", rows[*unseen].name, " cannot show pictures in a window on this display",
             "; --device chooses another; found ", names);
    if (wanted.empty())
        fail("no device can be used; expected one with Vulkan 1.3 that runs all kernels; found ", names);
    if (unfit)
        fail("device ", rows[*unfit].name, ", as ", wanted_by, " '", wanted,
             "' says, cannot be used: ", why_unfit(rows[*unfit]), "; found ", names);
    fail(wanted_by, " is '", wanted, "', which no device matches; found ", names);
}

}  // namespace shvr::gpu

// A Vulkan layer for tests: a device that is short of memory. While the file SHVR_DEVICE_SHORT_WHILE is there no memory
// of SHVR_DEVICE_SHORT_BYTES or more can be allocated, of any type, however often it is tried. The file
// SHVR_DEVICE_SHORT_LOG lists the bytes of each refused allocation, a line each. Any thread.

#include <cstdlib>
#include <fstream>

#include <unistd.h>

#include "chain.h"

namespace {

struct Shortage : layers::Unobtrusive {
    using Next = layers::Chain<Shortage>;

    static VKAPI_ATTR VkResult VKAPI_CALL allocate(VkDevice device, const VkMemoryAllocateInfo* info,
                                                   const VkAllocationCallbacks* allocator, VkDeviceMemory* memory)
    {
        const char *const least = std::getenv("SHVR_DEVICE_SHORT_BYTES"),
                          *const meanwhile = std::getenv("SHVR_DEVICE_SHORT_WHILE"),
                          *const log = std::getenv("SHVR_DEVICE_SHORT_LOG");
        if (least && meanwhile && info->allocationSize >= std::strtoull(least, nullptr, 10) &&
            access(meanwhile, F_OK) == 0) {
            if (log) std::ofstream(log, std::ios::app) << info->allocationSize << '\n';
            return VK_ERROR_OUT_OF_DEVICE_MEMORY;
        }
        return Next::next<PFN_vkAllocateMemory>(device, "vkAllocateMemory")(device, info, allocator, memory);
    }

    static PFN_vkVoidFunction hook(const char* name)
    {
        return std::strcmp(name, "vkAllocateMemory") == 0 ? reinterpret_cast<PFN_vkVoidFunction>(&allocate) : nullptr;
    }
};

}  // namespace

extern "C" VKAPI_ATTR VkResult VKAPI_CALL memory_negotiate(VkNegotiateLayerInterface* interface)
{
    return layers::Chain<Shortage>::negotiate(interface);
}

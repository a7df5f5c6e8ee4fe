// Sets handles to null when a call fails. Vulkan leaves the handles undefined. Dear ImGui's back end then frees memory
// twice: after destroying a vertex buffer and failing to create a larger one, it keeps the old handles. The linker
// redirects this program's calls of these Vulkan functions to the functions below (--wrap in CMakeLists.txt).
#include <vulkan/vulkan.h>

extern "C" {

VkResult __real_vkCreateBuffer(VkDevice, const VkBufferCreateInfo*, const VkAllocationCallbacks*, VkBuffer*);
VkResult __real_vkAllocateMemory(VkDevice, const VkMemoryAllocateInfo*, const VkAllocationCallbacks*, VkDeviceMemory*);

VkResult __wrap_vkCreateBuffer(VkDevice device, const VkBufferCreateInfo* info, const VkAllocationCallbacks* allocator,
                               VkBuffer* buffer)
{
    *buffer = VK_NULL_HANDLE;
    return __real_vkCreateBuffer(device, info, allocator, buffer);
}

VkResult __wrap_vkAllocateMemory(VkDevice device, const VkMemoryAllocateInfo* info,
                                 const VkAllocationCallbacks* allocator, VkDeviceMemory* memory)
{
    *memory = VK_NULL_HANDLE;
    return __real_vkAllocateMemory(device, info, allocator, memory);
}
}

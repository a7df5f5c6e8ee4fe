// A Vulkan layer for tests: memory is full of random bits when it is new, as on many GPUs. lavapipe's is full of zeros.
//
//   SHVR_NOISE=N                 the first random number, which is not 0
//
// For devices whose memory the host can map. Any thread.

#include <cstdlib>

#include "chain.h"

namespace {

uint64_t first_number()
{
    const char* const text = std::getenv("SHVR_NOISE");
    const uint64_t number = text ? std::strtoull(text, nullptr, 10) : 1;
    return number ? number : 1;
}

struct Noise : layers::Unobtrusive {
    using Next = layers::Chain<Noise>;

    static VKAPI_ATTR VkResult VKAPI_CALL allocate(VkDevice device, const VkMemoryAllocateInfo* info,
                                                   const VkAllocationCallbacks* allocator, VkDeviceMemory* memory)
    {
        const VkResult result =
            Next::next<PFN_vkAllocateMemory>(device, "vkAllocateMemory")(device, info, allocator, memory);
        if (result != VK_SUCCESS) return result;
        void* mapped = nullptr;
        if (Next::next<PFN_vkMapMemory>(device, "vkMapMemory")(device, *memory, 0, VK_WHOLE_SIZE, 0, &mapped) !=
            VK_SUCCESS)
            std::abort();  // a test with memory that is not noisy would test nothing
        static std::mutex mutex;
        static uint64_t random = first_number();
        {
            const std::lock_guard lock(mutex);
            auto* const words = static_cast<uint64_t*>(mapped);
            for (uint64_t i = 0; i < info->allocationSize / sizeof *words; ++i) {  // Marsaglia's xorshift
                random ^= random << 13;
                random ^= random >> 7;
                random ^= random << 17;
                words[i] = random;
            }
        }
        Next::next<PFN_vkUnmapMemory>(device, "vkUnmapMemory")(device, *memory);
        return result;
    }

    static PFN_vkVoidFunction hook(const char* name)
    {
        return std::strcmp(name, "vkAllocateMemory") == 0 ? reinterpret_cast<PFN_vkVoidFunction>(&allocate) : nullptr;
    }
};

}  // namespace

extern "C" VKAPI_ATTR VkResult VKAPI_CALL noise_negotiate(VkNegotiateLayerInterface* interface)
{
    return layers::Chain<Noise>::negotiate(interface);
}

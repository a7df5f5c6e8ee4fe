// A Vulkan layer for tests: timestamps of a device whose speed the test chooses. Its clock stands still but for
// dispatches, as they are recorded, so that times are exact.
//
//   SHVR_CLOCKS=N                nanoseconds that a workgroup takes, from now on
//   SHVR_CLOCKS_EARLY=N          nanoseconds by which stamps at the start of passes are early, from now on
//
// Of a device whose ticks are nanoseconds. One thread.

#include <cstdlib>
#include <map>
#include <utility>

#include "chain.h"

namespace {

uint64_t number_of(const char* variable)
{
    const char* const text = std::getenv(variable);
    return text ? std::strtoull(text, nullptr, 10) : 0;
}

uint64_t now_ns = 1'000'000'000;
std::map<std::pair<VkQueryPool, uint32_t>, uint64_t> stamps;

struct Clocks {
    using Next = layers::Chain<Clocks>;

    static VKAPI_ATTR void VKAPI_CALL dispatch(VkCommandBuffer commands, uint32_t x, uint32_t y, uint32_t z)
    {
        now_ns += uint64_t{x} * y * z * number_of("SHVR_CLOCKS");
        Next::next<PFN_vkCmdDispatch>(commands, "vkCmdDispatch")(commands, x, y, z);
    }
    static VKAPI_ATTR void VKAPI_CALL dispatch_base(VkCommandBuffer commands, uint32_t at_x, uint32_t at_y,
                                                    uint32_t at_z, uint32_t x, uint32_t y, uint32_t z)
    {
        now_ns += uint64_t{x} * y * z * number_of("SHVR_CLOCKS");
        Next::next<PFN_vkCmdDispatchBase>(commands, "vkCmdDispatchBase")(commands, at_x, at_y, at_z, x, y, z);
    }
    /// Pairs of stamps: starts have even numbers.
    static VKAPI_ATTR void VKAPI_CALL stamp(VkCommandBuffer commands, VkPipelineStageFlags2 stage, VkQueryPool pool,
                                            uint32_t query)
    {
        stamps[{pool, query}] = now_ns - (query % 2 == 0 ? number_of("SHVR_CLOCKS_EARLY") : 0);
        Next::next<PFN_vkCmdWriteTimestamp2>(commands, "vkCmdWriteTimestamp2")(commands, stage, pool, query);
    }
    static VKAPI_ATTR VkResult VKAPI_CALL results(VkDevice device, VkQueryPool pool, uint32_t first, uint32_t count,
                                                  size_t bytes, void* data, VkDeviceSize stride,
                                                  VkQueryResultFlags flags)
    {
        const VkResult result = Next::next<PFN_vkGetQueryPoolResults>(device, "vkGetQueryPoolResults")(
            device, pool, first, count, bytes, data, stride, flags);
        for (uint32_t i = 0; i < count; ++i)
            std::memcpy(static_cast<char*>(data) + i * stride, &stamps[{pool, first + i}], sizeof(uint64_t));
        return result;
    }

    static PFN_vkVoidFunction hook(const char* name)
    {
        const auto is = [&](const char* other) { return std::strcmp(name, other) == 0; };
        if (is("vkCmdDispatch")) return reinterpret_cast<PFN_vkVoidFunction>(&dispatch);
        if (is("vkCmdDispatchBase")) return reinterpret_cast<PFN_vkVoidFunction>(&dispatch_base);
        if (is("vkCmdWriteTimestamp2")) return reinterpret_cast<PFN_vkVoidFunction>(&stamp);
        if (is("vkGetQueryPoolResults")) return reinterpret_cast<PFN_vkVoidFunction>(&results);
        return nullptr;
    }
    static void instance_made(VkInstance) {}
    static void instance_goes(VkInstance) {}
    static VkDeviceCreateInfo device_info(const VkDeviceCreateInfo& info) { return info; }
};

}  // namespace

extern "C" VKAPI_ATTR VkResult VKAPI_CALL clocks_negotiate(VkNegotiateLayerInterface* interface)
{
    return layers::Chain<Clocks>::negotiate(interface);
}

// A Vulkan layer for tests: one memory barrier is left out, so that a test of barriers can be tested.
//
//   SHVR_DROP_BARRIER=3          the third global memory barrier since the instance was made; 0 or nothing: none
//   SHVR_BARRIERS_LOG=FILE       at the end: "barriers N", the number of those that count
//
// Validation reports no hazard where the host waits for a fence alone: barriers for the host do not count.

#include <atomic>
#include <cstdlib>
#include <fstream>

#include "chain.h"

namespace {

std::atomic<uint64_t> barriers{0};
std::atomic<uint64_t> dropped{0};

struct Barriers : layers::Unobtrusive {
    using Next = layers::Chain<Barriers>;

    static VKAPI_ATTR void VKAPI_CALL barrier(VkCommandBuffer commands, const VkDependencyInfo* info)
    {
        const bool counts = info->memoryBarrierCount == 1 && info->imageMemoryBarrierCount == 0 &&
                            !(info->pMemoryBarriers[0].dstStageMask & VK_PIPELINE_STAGE_2_HOST_BIT);
        if (counts && ++barriers == dropped) return;
        Next::next<PFN_vkCmdPipelineBarrier2>(commands, "vkCmdPipelineBarrier2")(commands, info);
    }

    static PFN_vkVoidFunction hook(const char* name)
    {
        return std::strcmp(name, "vkCmdPipelineBarrier2") == 0 ? reinterpret_cast<PFN_vkVoidFunction>(&barrier)
                                                               : nullptr;
    }
    static void instance_made(VkInstance)
    {
        const char* const number = std::getenv("SHVR_DROP_BARRIER");
        dropped = number ? std::strtoull(number, nullptr, 10) : 0;
        barriers = 0;
    }
    static void instance_goes(VkInstance)
    {
        if (const char* const path = std::getenv("SHVR_BARRIERS_LOG")) std::ofstream(path) << "barriers " << barriers;
    }
};

}  // namespace

extern "C" VKAPI_ATTR VkResult VKAPI_CALL barriers_negotiate(VkNegotiateLayerInterface* interface)
{
    return layers::Chain<Barriers>::negotiate(interface);
}

// A Vulkan layer for tests: a device that is infinitely fast. Dispatches, copies and fills are left out, so that what
// is left is what the program does, and how often it calls the driver (the log of VK_LAYER_SHVR_faults counts that).

#include "chain.h"

namespace {

template <class... Arguments>
VKAPI_ATTR void VKAPI_CALL nothing(Arguments...)
{}
template <class... Arguments>
PFN_vkVoidFunction nothing_for(void(VKAPI_PTR*)(Arguments...))
{
    return reinterpret_cast<PFN_vkVoidFunction>(&nothing<Arguments...>);
}

struct Speed : layers::Unobtrusive {
    static PFN_vkVoidFunction hook(const char* name)
    {
#define SHVR_LEAVE_OUT(call)                                                                                           \
    if (std::strcmp(name, #call) == 0) return nothing_for(PFN_##call(nullptr));
        SHVR_LEAVE_OUT(vkCmdDispatch)
        SHVR_LEAVE_OUT(vkCmdDispatchBase)
        SHVR_LEAVE_OUT(vkCmdCopyBuffer)
        SHVR_LEAVE_OUT(vkCmdCopyBufferToImage)
        SHVR_LEAVE_OUT(vkCmdCopyImageToBuffer)
        SHVR_LEAVE_OUT(vkCmdFillBuffer)
#undef SHVR_LEAVE_OUT
        return nullptr;
    }
};

}  // namespace

extern "C" VKAPI_ATTR VkResult VKAPI_CALL speed_negotiate(VkNegotiateLayerInterface* interface)
{
    return layers::Chain<Speed>::negotiate(interface);
}

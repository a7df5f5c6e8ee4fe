// A Vulkan layer for tests: logs which thread waits for the device or the screen.
//
//   SHVR_WAITS_LOG=FILE          "main CALL" or "other CALL" at the end of it for each call that does not return at
//                                once: a wait for fences or semaphores, or for an image of the screen, that are not
//                                there yet, and each wait for an idle queue or device
//   SHVR_WAITS_HELD=FILE         while the file exists, the device hangs: no wait ends, and nothing is there yet
//
// "main" is the program's first thread. Calls with a time limit of 0 ask and do not wait. Any thread.

#include <cstdlib>
#include <fstream>

#include <sys/syscall.h>
#include <unistd.h>

#include "chain.h"

namespace {

void note(const char* call)
{
    static std::mutex mutex;
    const std::lock_guard lock(mutex);
    if (const char* const path = std::getenv("SHVR_WAITS_LOG"))
        std::ofstream(path, std::ios::app) << (syscall(SYS_gettid) == getpid() ? "main " : "other ") << call << '\n';
}

bool is_held()
{
    const char* const path = std::getenv("SHVR_WAITS_HELD");
    return path && access(path, F_OK) == 0;
}

void wait_while_held()
{
    while (is_held()) usleep(20'000);
}

struct Waits : layers::Unobtrusive {
    using Next = layers::Chain<Waits>;

    static VKAPI_ATTR VkResult VKAPI_CALL fences(VkDevice device, uint32_t count, const VkFence* fences, VkBool32 all,
                                                 uint64_t timeout_ns)
    {
        const auto wait = Next::next<PFN_vkWaitForFences>(device, "vkWaitForFences");
        if (timeout_ns == 0 && is_held()) return VK_TIMEOUT;
        wait_while_held();
        const VkResult now = wait(device, count, fences, all, 0);
        if (now != VK_TIMEOUT || timeout_ns == 0) return now;
        note("vkWaitForFences");
        return wait(device, count, fences, all, timeout_ns);
    }

    static VKAPI_ATTR VkResult VKAPI_CALL semaphores(VkDevice device, const VkSemaphoreWaitInfo* info,
                                                     uint64_t timeout_ns)
    {
        const auto wait = Next::next<PFN_vkWaitSemaphores>(device, "vkWaitSemaphores");
        if (timeout_ns == 0 && is_held()) return VK_TIMEOUT;
        wait_while_held();
        const VkResult now = wait(device, info, 0);
        if (now != VK_TIMEOUT || timeout_ns == 0) return now;
        note("vkWaitSemaphores");
        return wait(device, info, timeout_ns);
    }

    static VKAPI_ATTR VkResult VKAPI_CALL acquire(VkDevice device, VkSwapchainKHR swapchain, uint64_t timeout_ns,
                                                  VkSemaphore semaphore, VkFence fence, uint32_t* index)
    {
        const auto next = Next::next<PFN_vkAcquireNextImageKHR>(device, "vkAcquireNextImageKHR");
        const VkResult now = next(device, swapchain, 0, semaphore, fence, index);
        if ((now != VK_TIMEOUT && now != VK_NOT_READY) || timeout_ns == 0) return now;
        note("vkAcquireNextImageKHR");
        return next(device, swapchain, timeout_ns, semaphore, fence, index);
    }

    static VKAPI_ATTR VkResult VKAPI_CALL queue_idle(VkQueue queue)
    {
        note("vkQueueWaitIdle");
        wait_while_held();
        return Next::next<PFN_vkQueueWaitIdle>(queue, "vkQueueWaitIdle")(queue);
    }

    static VKAPI_ATTR VkResult VKAPI_CALL device_idle(VkDevice device)
    {
        note("vkDeviceWaitIdle");
        wait_while_held();
        return Next::next<PFN_vkDeviceWaitIdle>(device, "vkDeviceWaitIdle")(device);
    }

    static PFN_vkVoidFunction hook(const char* name)
    {
        const auto is = [&](const char* other) { return std::strcmp(name, other) == 0; };
        if (is("vkWaitForFences")) return reinterpret_cast<PFN_vkVoidFunction>(&fences);
        if (is("vkWaitSemaphores")) return reinterpret_cast<PFN_vkVoidFunction>(&semaphores);
        if (is("vkAcquireNextImageKHR")) return reinterpret_cast<PFN_vkVoidFunction>(&acquire);
        if (is("vkQueueWaitIdle")) return reinterpret_cast<PFN_vkVoidFunction>(&queue_idle);
        if (is("vkDeviceWaitIdle")) return reinterpret_cast<PFN_vkVoidFunction>(&device_idle);
        return nullptr;
    }
};

}  // namespace

extern "C" VKAPI_ATTR VkResult VKAPI_CALL waits_negotiate(VkNegotiateLayerInterface* interface)
{
    return layers::Chain<Waits>::negotiate(interface);
}

// A Vulkan layer for tests: a screen that is slow to give images back, as real ones are. Two images, one of which is
// always shown, and a vertical blank every 16.7 ms: an image is free once the next one has taken its place.
//
//   SHVR_SCREEN_HIDDEN=FILE      while that file exists no image is free at all, as for a hidden window
//   SHVR_SCREEN_BLANK_US=N       microseconds between blanks, instead of 16700
//   SHVR_SCREEN_FIFO=1           images can be shown in turn only, and presenting waits for the next blank, as some
//                                drivers do
//   SHVR_SCREEN_LOG=FILE         at the end: "acquired N", "refused N" (for now, without waiting), "waited N" (calls
//                                that did not return at once), "swapchains N", "mailboxes N" (those of
//                                them whose presenting waits for no blank), "waited_for_blank N" (presents that did),
//                                "filled N" (those of them behind whose frame other work was submitted)

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <fstream>
#include <thread>

#include <unistd.h>

#include "chain.h"

namespace {

using Clock = std::chrono::steady_clock;
constexpr size_t IMAGES = 2;

struct State {
    std::mutex mutex;
    std::deque<Clock::time_point> shown;  ///< when each image that was presented gets to the screen; the last ones
    uint64_t acquired = 0, refused = 0, waited = 0, swapchains = 0, mailboxes = 0;
    uint64_t waited_for_blank = 0, filled = 0, submitted_behind_frame = 0;
};
State& state()
{
    static State* const one = new State;
    return *one;
}

std::chrono::microseconds blank()
{
    const char* const text = std::getenv("SHVR_SCREEN_BLANK_US");
    return std::chrono::microseconds(text ? std::strtoll(text, nullptr, 10) : 16700);
}

bool shows_in_turn()
{
    return std::getenv("SHVR_SCREEN_FIFO") != nullptr;
}

bool is_hidden()
{
    const char* const path = std::getenv("SHVR_SCREEN_HIDDEN");
    return path && access(path, F_OK) == 0;
}

/// Whether one of the images is neither shown nor waiting to be shown.
bool has_free_image(State& known)
{
    if (is_hidden()) return false;
    const Clock::time_point now = Clock::now();
    while (known.shown.size() > 1 && known.shown[1] <= now) known.shown.pop_front();
    return known.shown.size() < IMAGES;
}

struct Screen : layers::Unobtrusive {
    using Next = layers::Chain<Screen>;

    static VKAPI_ATTR VkResult VKAPI_CALL acquire(VkDevice device, VkSwapchainKHR swapchain, uint64_t timeout_ns,
                                                  VkSemaphore semaphore, VkFence fence, uint32_t* index)
    {
        State& known = state();
        const Clock::time_point begun = Clock::now();
        bool has_waited = false;
        for (;;) {
            {
                const std::lock_guard lock(known.mutex);
                if (has_free_image(known)) {
                    ++known.acquired;
                    known.waited += has_waited;
                    break;
                }
                const auto gone = std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - begun);
                if (uint64_t(gone.count()) >= timeout_ns) {
                    ++known.refused;
                    known.waited += has_waited;
                    return timeout_ns == 0 ? VK_NOT_READY : VK_TIMEOUT;
                }
                has_waited = true;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        return Next::next<PFN_vkAcquireNextImageKHR>(device, "vkAcquireNextImageKHR")(device, swapchain, UINT64_MAX,
                                                                                      semaphore, fence, index);
    }

    static VKAPI_ATTR VkResult VKAPI_CALL present(VkQueue queue, const VkPresentInfoKHR* info)
    {
        State& known = state();
        Clock::time_point next_blank;
        {
            const std::lock_guard lock(known.mutex);
            const auto blanks = Clock::now().time_since_epoch() / blank() + 1;
            Clock::time_point at{std::chrono::duration_cast<Clock::duration>(blank() * blanks)};
            next_blank = at;
            known.waited_for_blank += shows_in_turn();
            known.filled += shows_in_turn() && known.submitted_behind_frame > 0;
            if (!known.shown.empty()) at = std::max(at, known.shown.back() + blank());
            known.shown.push_back(at);
        }
        if (shows_in_turn()) std::this_thread::sleep_until(next_blank);
        return Next::next<PFN_vkQueuePresentKHR>(queue, "vkQueuePresentKHR")(queue, info);
    }

    /// A frame of the window is what signals a semaphore, for its presenting.
    static VKAPI_ATTR VkResult VKAPI_CALL submit(VkQueue queue, uint32_t count, const VkSubmitInfo2* infos,
                                                 VkFence fence)
    {
        {
            const std::lock_guard lock(state().mutex);
            const bool is_frame = count > 0 && infos[0].signalSemaphoreInfoCount > 0;
            state().submitted_behind_frame = is_frame ? 0 : state().submitted_behind_frame + 1;
        }
        return Next::next<PFN_vkQueueSubmit2>(queue, "vkQueueSubmit2")(queue, count, infos, fence);
    }

    static VKAPI_ATTR VkResult VKAPI_CALL modes(VkPhysicalDevice physical, VkSurfaceKHR surface, uint32_t* count,
                                                VkPresentModeKHR* found)
    {
        constexpr const char* NAME = "vkGetPhysicalDeviceSurfacePresentModesKHR";
        if (!shows_in_turn())
            return Next::next_of_instance<PFN_vkGetPhysicalDeviceSurfacePresentModesKHR>(physical, NAME)(
                physical, surface, count, found);
        if (found && *count > 0) found[0] = VK_PRESENT_MODE_FIFO_KHR;
        *count = 1;
        return VK_SUCCESS;
    }

    static VKAPI_ATTR VkResult VKAPI_CALL create(VkDevice device, const VkSwapchainCreateInfoKHR* info,
                                                 const VkAllocationCallbacks* allocator, VkSwapchainKHR* swapchain)
    {
        {
            const std::lock_guard lock(state().mutex);
            ++state().swapchains;
            state().mailboxes += info->presentMode == VK_PRESENT_MODE_MAILBOX_KHR;
            state().shown.clear();
        }
        return Next::next<PFN_vkCreateSwapchainKHR>(device, "vkCreateSwapchainKHR")(device, info, allocator, swapchain);
    }

    static PFN_vkVoidFunction hook(const char* name)
    {
        const auto is = [&](const char* other) { return std::strcmp(name, other) == 0; };
        if (is("vkAcquireNextImageKHR")) return reinterpret_cast<PFN_vkVoidFunction>(&acquire);
        if (is("vkQueuePresentKHR")) return reinterpret_cast<PFN_vkVoidFunction>(&present);
        if (is("vkQueueSubmit2")) return reinterpret_cast<PFN_vkVoidFunction>(&submit);
        if (is("vkGetPhysicalDeviceSurfacePresentModesKHR")) return reinterpret_cast<PFN_vkVoidFunction>(&modes);
        if (is("vkCreateSwapchainKHR")) return reinterpret_cast<PFN_vkVoidFunction>(&create);
        return nullptr;
    }
    static void instance_goes(VkInstance)
    {
        const char* const path = std::getenv("SHVR_SCREEN_LOG");
        if (!path) return;
        const State& known = state();
        std::ofstream(path) << "acquired " << known.acquired << "\nrefused " << known.refused << "\nwaited "
                            << known.waited << "\nswapchains " << known.swapchains << "\nmailboxes " << known.mailboxes
                            << "\nwaited_for_blank " << known.waited_for_blank << "\nfilled " << known.filled << '\n';
    }
};

}  // namespace

extern "C" VKAPI_ATTR VkResult VKAPI_CALL screen_negotiate(VkNegotiateLayerInterface* interface)
{
    return layers::Chain<Screen>::negotiate(interface);
}

// A Vulkan layer for tests: between two barriers commands run in any order, as they may on a GPU. lavapipe runs them in
// their order, so that a missing barrier goes unnoticed.
//
//   SHVR_SHUFFLE=N               the first random number, which is not 0; nothing: they run backwards
//   SHVR_SHUFFLE_LOG=FILE        at the end: "moved N", the number of commands that ran before an earlier one
//
// Shuffles dispatches, copies and fills; each command buffer is one thread's.

#include <atomic>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <random>
#include <utility>

#include "chain.h"

namespace {

using Command = std::function<void()>;

/// Commands recorded in a command buffer and not yet passed on.
struct Recorded {
    std::vector<Command> waiting;
    Command pipeline, sets, constants;  ///< as they are bound now
};

struct State {
    std::mutex mutex;
    std::map<VkCommandBuffer, Recorded> recorded;
    std::minstd_rand random;
    bool is_random = false;
    std::atomic<uint64_t> moved{0};
};
State& state()
{
    static State* const one = new State;
    return *one;
}

Recorded& recorded_in(VkCommandBuffer commands)
{
    const std::lock_guard lock(state().mutex);
    return state().recorded[commands];
}

/// Passes on what waits.
void flush(VkCommandBuffer commands)
{
    std::vector<Command> waiting = std::exchange(recorded_in(commands).waiting, {});
    if (waiting.size() < 2) {
        for (const Command& command : waiting) command();
        return;
    }
    std::vector<size_t> order(waiting.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = order.size() - 1 - i;
    if (state().is_random) {
        const std::lock_guard lock(state().mutex);
        std::shuffle(order.begin(), order.end(), state().random);
    }
    for (size_t i = 0; i < order.size(); ++i) {
        waiting[order[i]]();
        state().moved +=
            std::any_of(order.begin() + std::ptrdiff_t(i), order.end(), [&](size_t later) { return later < order[i]; });
    }
}

template <class Call>
Call next(VkCommandBuffer commands, const char* name);

/// Calls that only wait until the next barrier.
template <class Call, class... Arguments>
void wait(const char* name, VkCommandBuffer commands, Arguments... arguments)
{
    const Call call = next<Call>(commands, name);
    recorded_in(commands).waiting.push_back([=] { call(commands, arguments...); });
}

void dispatch(VkCommandBuffer commands, const Command& call)
{
    Recorded& recorded = recorded_in(commands);
    recorded.waiting.push_back(
        [pipeline = recorded.pipeline, sets = recorded.sets, constants = recorded.constants, call] {
            pipeline();
            sets();
            if (constants) constants();
            call();
        });
}

struct Shuffle {
    using Next = layers::Chain<Shuffle>;

    static VKAPI_ATTR void VKAPI_CALL bind_pipeline(VkCommandBuffer commands, VkPipelineBindPoint point,
                                                    VkPipeline pipeline)
    {
        const auto call = next<PFN_vkCmdBindPipeline>(commands, "vkCmdBindPipeline");
        Recorded& recorded = recorded_in(commands);
        recorded.pipeline = [=] { call(commands, point, pipeline); };
        recorded.constants = nullptr;  // a pipeline's own
    }
    static VKAPI_ATTR void VKAPI_CALL bind_sets(VkCommandBuffer commands, VkPipelineBindPoint point,
                                                VkPipelineLayout layout, uint32_t first, uint32_t count,
                                                const VkDescriptorSet* sets, uint32_t offset_count,
                                                const uint32_t* offsets)
    {
        const auto call = next<PFN_vkCmdBindDescriptorSets>(commands, "vkCmdBindDescriptorSets");
        const std::vector<VkDescriptorSet> all(sets, sets + count);
        const std::vector<uint32_t> of_all(offsets, offsets + offset_count);
        recorded_in(commands).sets = [=] {
            call(commands, point, layout, first, uint32_t(all.size()), all.data(), uint32_t(of_all.size()),
                 of_all.data());
        };
    }
    static VKAPI_ATTR void VKAPI_CALL push(VkCommandBuffer commands, VkPipelineLayout layout, VkShaderStageFlags stages,
                                           uint32_t offset, uint32_t size, const void* values)
    {
        const auto call = next<PFN_vkCmdPushConstants>(commands, "vkCmdPushConstants");
        const auto* const bytes = static_cast<const std::byte*>(values);
        const std::vector<std::byte> all(bytes, bytes + size);
        recorded_in(commands).constants = [=] {
            call(commands, layout, stages, offset, uint32_t(all.size()), all.data());
        };
    }
    static VKAPI_ATTR void VKAPI_CALL dispatch_all(VkCommandBuffer commands, uint32_t x, uint32_t y, uint32_t z)
    {
        const auto call = next<PFN_vkCmdDispatch>(commands, "vkCmdDispatch");
        dispatch(commands, [=] { call(commands, x, y, z); });
    }
    static VKAPI_ATTR void VKAPI_CALL dispatch_part(VkCommandBuffer commands, uint32_t at_x, uint32_t at_y,
                                                    uint32_t at_z, uint32_t x, uint32_t y, uint32_t z)
    {
        const auto call = next<PFN_vkCmdDispatchBase>(commands, "vkCmdDispatchBase");
        dispatch(commands, [=] { call(commands, at_x, at_y, at_z, x, y, z); });
    }
    static VKAPI_ATTR void VKAPI_CALL copy_buffer(VkCommandBuffer commands, VkBuffer from, VkBuffer to, uint32_t count,
                                                  const VkBufferCopy* regions)
    {
        const auto call = next<PFN_vkCmdCopyBuffer>(commands, "vkCmdCopyBuffer");
        const std::vector<VkBufferCopy> all(regions, regions + count);
        recorded_in(commands).waiting.push_back([=] { call(commands, from, to, uint32_t(all.size()), all.data()); });
    }
    static VKAPI_ATTR void VKAPI_CALL copy_to_image(VkCommandBuffer commands, VkBuffer from, VkImage to,
                                                    VkImageLayout layout, uint32_t count,
                                                    const VkBufferImageCopy* regions)
    {
        const auto call = next<PFN_vkCmdCopyBufferToImage>(commands, "vkCmdCopyBufferToImage");
        const std::vector<VkBufferImageCopy> all(regions, regions + count);
        recorded_in(commands).waiting.push_back(
            [=] { call(commands, from, to, layout, uint32_t(all.size()), all.data()); });
    }
    static VKAPI_ATTR void VKAPI_CALL copy_to_buffer(VkCommandBuffer commands, VkImage from, VkImageLayout layout,
                                                     VkBuffer to, uint32_t count, const VkBufferImageCopy* regions)
    {
        const auto call = next<PFN_vkCmdCopyImageToBuffer>(commands, "vkCmdCopyImageToBuffer");
        const std::vector<VkBufferImageCopy> all(regions, regions + count);
        recorded_in(commands).waiting.push_back(
            [=] { call(commands, from, layout, to, uint32_t(all.size()), all.data()); });
    }
    static VKAPI_ATTR void VKAPI_CALL fill(VkCommandBuffer commands, VkBuffer buffer, VkDeviceSize offset,
                                           VkDeviceSize size, uint32_t value)
    {
        wait<PFN_vkCmdFillBuffer>("vkCmdFillBuffer", commands, buffer, offset, size, value);
    }
    static VKAPI_ATTR void VKAPI_CALL clear(VkCommandBuffer commands, VkImage image, VkImageLayout layout,
                                            const VkClearColorValue* color, uint32_t count,
                                            const VkImageSubresourceRange* ranges)
    {
        const auto call = next<PFN_vkCmdClearColorImage>(commands, "vkCmdClearColorImage");
        const std::vector<VkImageSubresourceRange> all(ranges, ranges + count);
        recorded_in(commands).waiting.push_back(
            [=, value = *color] { call(commands, image, layout, &value, uint32_t(all.size()), all.data()); });
    }
    static VKAPI_ATTR void VKAPI_CALL barrier(VkCommandBuffer commands, const VkDependencyInfo* info)
    {
        flush(commands);
        next<PFN_vkCmdPipelineBarrier2>(commands, "vkCmdPipelineBarrier2")(commands, info);
    }
    static VKAPI_ATTR VkResult VKAPI_CALL end(VkCommandBuffer commands)
    {
        flush(commands);
        {
            const std::lock_guard lock(state().mutex);
            state().recorded.erase(commands);
        }
        return next<PFN_vkEndCommandBuffer>(commands, "vkEndCommandBuffer")(commands);
    }

    static PFN_vkVoidFunction hook(const char* name)
    {
#define SHVR_HOOK(call, with)                                                                                          \
    if (std::strcmp(name, #call) == 0) return reinterpret_cast<PFN_vkVoidFunction>(static_cast<PFN_##call>(&with));
        SHVR_HOOK(vkCmdBindPipeline, bind_pipeline)
        SHVR_HOOK(vkCmdBindDescriptorSets, bind_sets)
        SHVR_HOOK(vkCmdPushConstants, push)
        SHVR_HOOK(vkCmdDispatch, dispatch_all)
        SHVR_HOOK(vkCmdDispatchBase, dispatch_part)
        SHVR_HOOK(vkCmdCopyBuffer, copy_buffer)
        SHVR_HOOK(vkCmdCopyBufferToImage, copy_to_image)
        SHVR_HOOK(vkCmdCopyImageToBuffer, copy_to_buffer)
        SHVR_HOOK(vkCmdFillBuffer, fill)
        SHVR_HOOK(vkCmdClearColorImage, clear)
        SHVR_HOOK(vkCmdPipelineBarrier2, barrier)
        SHVR_HOOK(vkEndCommandBuffer, end)
#undef SHVR_HOOK
        return nullptr;
    }
    static void instance_made(VkInstance)
    {
        const char* const number = std::getenv("SHVR_SHUFFLE");
        state().is_random = number != nullptr;
        if (number) state().random.seed(uint32_t(std::strtoul(number, nullptr, 10)));
    }
    static void instance_goes(VkInstance)
    {
        if (const char* const path = std::getenv("SHVR_SHUFFLE_LOG"))
            std::ofstream(path) << "moved " << state().moved << '\n';
    }
    static VkDeviceCreateInfo device_info(const VkDeviceCreateInfo& info)
    {
        return info;
    }
};

template <class Call>
Call next(VkCommandBuffer commands, const char* name)
{
    return Shuffle::Next::next<Call>(commands, name);
}

}  // namespace

extern "C" VKAPI_ATTR VkResult VKAPI_CALL shuffle_negotiate(VkNegotiateLayerInterface* interface)
{
    return layers::Chain<Shuffle>::negotiate(interface);
}

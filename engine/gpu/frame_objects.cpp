#include "engine/gpu/frame_objects.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace shvr::gpu {

FrameObjects::~FrameObjects()
{
    const VkDevice device = device_.handle();
    vkDestroyFence(device, fence_, nullptr);
    vkDestroyCommandPool(device, pool_, nullptr);
    vkDestroyQueryPool(device, queries_.pool, nullptr);
    vkDestroyQueryPool(device, statistics_.pool, nullptr);
    vkDestroyDescriptorPool(device, descriptors_, nullptr);
}

void FrameObjects::renew(const Needs& needs)
{
    const VkDevice device = device_.handle();
    if (fence_) {
        SHVR_VK(vkResetFences(device, 1, &fence_));
    } else {
        const VkFenceCreateInfo info{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
        SHVR_VK(vkCreateFence(device, &info, nullptr, &fence_));
    }
    if (pool_) {
        SHVR_VK(vkResetCommandPool(device, pool_, 0));
    } else {
        const VkCommandPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                           .flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT,
                                           .queueFamilyIndex = device_.queue_family()};
        SHVR_VK(vkCreateCommandPool(device, &info, nullptr, &pool_));
        device_.set_name(VK_OBJECT_TYPE_COMMAND_POOL, reinterpret_cast<uint64_t>(pool_), "frame");
    }
    begun_ = 0;
    renew_queries(queries_, VK_QUERY_TYPE_TIMESTAMP, needs.queries);
    renew_queries(statistics_, VK_QUERY_TYPE_PIPELINE_STATISTICS, needs.statistics);
    renew_descriptors(needs);
}

void FrameObjects::renew_queries(Queries& queries, VkQueryType type, uint32_t count)
{
    constexpr uint32_t LEAST = 64;
    if (count > queries.count) {
        vkDestroyQueryPool(device_.handle(), std::exchange(queries.pool, VK_NULL_HANDLE), nullptr);
        queries.count = 0;
        const bool is_statistics = type == VK_QUERY_TYPE_PIPELINE_STATISTICS;
        const VkQueryPoolCreateInfo info{
            .sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
            .queryType = type,
            .queryCount = std::bit_ceil(std::max(count, LEAST)),
            .pipelineStatistics = is_statistics ? VkQueryPipelineStatisticFlags(
                                                      VK_QUERY_PIPELINE_STATISTIC_COMPUTE_SHADER_INVOCATIONS_BIT)
                                                : 0};
        SHVR_VK(vkCreateQueryPool(device_.handle(), &info, nullptr, &queries.pool));
        queries.count = info.queryCount;
    }
    if (count > 0) vkResetQueryPool(device_.handle(), queries.pool, 0, count);
}

void FrameObjects::renew_descriptors(const Needs& needs)
{
    constexpr uint32_t LEAST = 16;
    const auto has_room = [&](const auto& wanted) {
        const auto found = room_.descriptors.find(wanted.first);
        return found != room_.descriptors.end() && found->second >= wanted.second;
    };
    if (needs.sets <= room_.sets && std::ranges::all_of(needs.descriptors, has_room)) {
        if (descriptors_) SHVR_VK(vkResetDescriptorPool(device_.handle(), descriptors_, 0));
        return;
    }
    vkDestroyDescriptorPool(device_.handle(), std::exchange(descriptors_, VK_NULL_HANDLE), nullptr);
    Needs room = std::exchange(room_, {});
    room.sets = std::bit_ceil(std::max({needs.sets, room.sets, LEAST}));
    std::vector<VkDescriptorPoolSize> sizes;
    for (const auto& [type, count] : needs.descriptors)
        room.descriptors[type] = std::max(room.descriptors[type], count);
    for (auto& [type, count] : room.descriptors) {
        count = std::bit_ceil(std::max(count, LEAST));
        sizes.push_back({type, count});
    }
    const VkDescriptorPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                          .maxSets = room.sets,
                                          .poolSizeCount = uint32_t(sizes.size()),
                                          .pPoolSizes = sizes.data()};
    SHVR_VK(vkCreateDescriptorPool(device_.handle(), &info, nullptr, &descriptors_));
    room_ = std::move(room);
}

VkCommandBuffer FrameObjects::begin_commands()
{
    if (begun_ == commands_.size()) {
        const VkCommandBufferAllocateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                               .commandPool = pool_,
                                               .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                               .commandBufferCount = 1};
        VkCommandBuffer made = VK_NULL_HANDLE;
        SHVR_VK(vkAllocateCommandBuffers(device_.handle(), &info, &made));
        commands_.push_back(made);
    }
    const VkCommandBuffer commands = commands_[begun_++];
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    SHVR_VK(vkBeginCommandBuffer(commands, &begin));
    return commands;
}

VkDescriptorSet FrameObjects::allocate(VkDescriptorSetLayout layout)
{
    const VkDescriptorSetAllocateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                           .descriptorPool = descriptors_,
                                           .descriptorSetCount = 1,
                                           .pSetLayouts = &layout};
    VkDescriptorSet set = VK_NULL_HANDLE;
    SHVR_VK(vkAllocateDescriptorSets(device_.handle(), &info, &set));
    return set;
}

}  // namespace shvr::gpu

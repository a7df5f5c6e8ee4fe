#pragma once
// The driver objects of a frame in flight, apart from memory: a fence, command buffers, queries and descriptors. They
// are created once and reused by later frames, because drivers need more time to create them than to use them. Used by
// one thread at a time.

#include <map>
#include <vector>

#include "engine/gpu/device.h"

namespace shvr::gpu {

class FrameObjects {
public:
    struct Needs {
        uint32_t queries = 0;     ///< timestamp queries
        uint32_t statistics = 0;  ///< queries that count compute invocations
        uint32_t sets = 0;
        std::map<VkDescriptorType, uint32_t> descriptors;
    };
    explicit FrameObjects(Device& device) : device_(device) {}
    ~FrameObjects();
    FrameObjects(const FrameObjects&) = delete;
    FrameObjects& operator=(const FrameObjects&) = delete;

    /// Prepares the objects for another frame. The device must have finished the previous frame. Throws if memory runs
    /// out; may then be called again.
    void renew(const Needs& needs);
    /// Begins another command buffer of this frame.
    VkCommandBuffer begin_commands();
    VkDescriptorSet allocate(VkDescriptorSetLayout layout);

    VkFence fence() const { return fence_; }
    VkQueryPool queries() const { return queries_.pool; }
    VkQueryPool statistics() const { return statistics_.pool; }

private:
    struct Queries {
        VkQueryPool pool = VK_NULL_HANDLE;
        uint32_t count = 0;
    };
    void renew_queries(Queries& queries, VkQueryType type, uint32_t count);
    void renew_descriptors(const Needs& needs);

    Device& device_;
    VkFence fence_ = VK_NULL_HANDLE;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    std::vector<VkCommandBuffer> commands_;
    size_t begun_ = 0;  ///< number of command buffers in use
    Queries queries_, statistics_;
    VkDescriptorPool descriptors_ = VK_NULL_HANDLE;
    Needs room_;  ///< capacity of the descriptor pool
};

}  // namespace shvr::gpu

#pragma once
// What a frame in flight needs of the driver beside memory: a fence, command buffers, queries and descriptors. Made
// once and used again by later frames, since making them takes drivers longer than using them. One thread at a time.

#include <map>
#include <vector>

#include "engine/gpu/device.h"

namespace shvr::gpu {

class FrameObjects {
public:
    struct Needs {
        uint32_t queries = 0;     ///< of timestamps
        uint32_t statistics = 0;  ///< queries of compute invocations
        uint32_t sets = 0;
        std::map<VkDescriptorType, uint32_t> descriptors;
    };
    explicit FrameObjects(Device& device) : device_(device) {}
    ~FrameObjects();
    FrameObjects(const FrameObjects&) = delete;
    FrameObjects& operator=(const FrameObjects&) = delete;

    /// Ready for another frame; the device must be done with the one before. Throws where memory is short; it may be
    /// called again afterwards.
    void renew(const Needs& needs);
    /// Another command buffer of this frame, begun.
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
    size_t begun_ = 0;  ///< of the command buffers
    Queries queries_, statistics_;
    VkDescriptorPool descriptors_ = VK_NULL_HANDLE;
    Needs room_;  ///< in the descriptor pool
};

}  // namespace shvr::gpu

#pragma once
// A graph in flight, from declaration to results, for executor.cpp only. Holds the memory and driver objects that it
// needs (frame_prepare.cpp), its commands (frame_record.cpp, frame_copies.cpp) and its results (frame_collect.cpp).

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "engine/gpu/executor.h"

namespace shvr::gpu {

inline constexpr uint64_t COUNTER_ROW_BYTES = COUNTERS * sizeof(uint64_t);

inline uint64_t aligned(uint64_t bytes, uint64_t alignment)
{
    return (bytes + alignment - 1) / alignment * alignment;
}

/// Converts a graph's stages to Vulkan's stages, and to the accesses that a barrier between them must cover.
VkPipelineStageFlags2 vulkan_stages(Stages stages);
VkAccessFlags2 touched_by(Stages stages);
void record_barrier(VkCommandBuffer commands, const Barrier& barrier);

/// Number of thread groups along each axis.
inline glm::uvec3 groups_for(const glm::uvec3& threads, const glm::uvec3& local)
{
    return (threads + local - 1u) / local;
}
uint64_t threads_of(const glm::uvec3& groups, const glm::uvec3& local);
/// Number of threads of a pass, including idle threads of partly filled groups.
uint64_t threads_of(const PassData& pass, const Kernel& kernel);

/// One graph in flight, with everything that must live until the device has finished it.
struct Submission::Frame {
    Executor& executor;
    const FrameGraph graph;
    const Executor::Options options;
    const CompiledGraph compiled;
    std::vector<Storage*> storages;  // per resource, transients only
    std::vector<Storage*> taken;     // transients to release
    std::vector<Storage*> read_backs;
    Storage* blocks = nullptr;
    Storage* counters = nullptr;
    Storage* work_counters = nullptr;  // counters in device memory, for kernels that count often; copied to `counters`
                                       // at the end
    uint64_t counter_bytes = 0;        // bytes per pass
    std::unique_ptr<FrameObjects> objects;
    bool is_timed = false;
    std::vector<size_t> counted_steps;  // index of the counted step, for each statistics query
    uint32_t statistics_room = 0;       // capacity in queries; 0: no query pool is created
    bool is_in_query = false;
    uint64_t number = 0;                  // number of the frame's last submission; 0: none
    std::vector<VkCommandBuffer> chunks;  // one command buffer for each submission
    double chunk_ms = 0.0;                // estimated time of the commands recorded so far in the last chunk
    VkPipeline in_use = VK_NULL_HANDLE;   // the pipeline bound in the last chunk
    std::chrono::steady_clock::time_point started;
    struct Prepared {
        const Kernel* kernel = nullptr;
        VkDescriptorSet set = VK_NULL_HANDLE;
        uint64_t counters_offset = 0;
        uint32_t dispatches = 0;
        uint32_t tiles = 0;
        uint32_t submissions = 0;
        bool is_counted_in_part = false;
        std::chrono::steady_clock::time_point recorded{};
        std::chrono::steady_clock::duration recording{0};  // binding included
    };
    std::vector<Prepared> prepared;             // one for each step
    std::vector<Memory::Object*> transitioned;  // images whose undefined layout the first chunk transitions to GENERAL

    Frame(Executor& owner, FrameGraph frame_graph, const Executor::Options& frame_options)
        : executor(owner), graph(std::move(frame_graph)), options(frame_options), compiled(graph.compile())
    {}
    Frame(const Frame&) = delete;
    Frame& operator=(const Frame&) = delete;
    ~Frame()
    {
        if (number > 0) {
            const VkFence fence = objects->fence();
            vkWaitForFences(executor.device_.handle(), 1, &fence, VK_TRUE, UINT64_MAX);
            executor.device_.note_done(number);
            executor.memory_.collect();
        }
        if (objects) executor.idle_objects_.push_back(std::move(objects));
        for (const auto& transient : executor.transients_)
            for (Storage* storage : taken)
                if (&transient->storage == storage) transient->taken = false;
    }

    const PassData& pass(const Step& step) const { return graph.passes()[step.pass]; }
    Storage& take(const std::string& name, const ResourceDesc& desc, Placement placement, bool is_counted_in = false)
    {
        taken.push_back(&executor.take_transient(name, desc, placement, is_counted_in));
        return *taken.back();
    }
    Storage& take_resource(const FrameGraph::ResourceData& resource);
    uint32_t object_id(uint32_t resource) const
    {
        const FrameGraph::ResourceData& data = graph.resources()[resource];
        return data.imported ? data.import_id : storages[resource]->import().id;
    }
    Memory::Object& object(uint32_t resource) const { return executor.memory_.object(object_id(resource)); }

    bool counts_work() const;
    void take_counters(uint64_t bytes, bool are_copied);
    void take_objects();
    void prepare();
    void write_descriptors(const PassData& pass, const Prepared& step, uint64_t& block_offset) const;
    void begin_chunk();
    void end_chunk();
    void begin_statistics(Prepared& state);
    void end_statistics();
    void make_room(double ms, Prepared& state);
    void record();
    void record_pass(const Step& step, Prepared& state);
    void record_dispatches(const PassData& pass, Prepared& state);
    void bind(const PassData& pass, const Prepared& state);
    template <class Part, class Copy>
    void record_parts(Prepared& state, const std::string& name, const std::vector<Part>& parts, const Copy& copy);
    void record_copy(const PassData& pass, Prepared& state);
    void record_copy_to_image(const PassData& pass, Prepared& state);
    void record_read_back(const PassData& pass, Prepared& state);
    void record_fill(const PassData& pass, Prepared& state);
    void record_clear(const PassData& pass, const Memory::Object& image, Prepared& state);
    void note_unknown_states() const;
    void transition_new_images();
    void submit();
    bool done() const;
    void wait() const;
    std::vector<std::vector<std::byte>> copy_read_backs() const;
    FrameResult collect();
};

}  // namespace shvr::gpu

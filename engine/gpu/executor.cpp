#include "engine/gpu/executor.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>
#include <utility>

#include "engine/graph/copy_parts.h"

namespace shvr::gpu {

namespace {

constexpr uint64_t COUNTER_BYTES = COUNTERS * sizeof(uint64_t);

VkPipelineStageFlags2 vulkan_stages(Stages stages)
{
    VkPipelineStageFlags2 flags = 0;
    if (stages & STAGE_COMPUTE) flags |= VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
    if (stages & STAGE_TRANSFER) flags |= VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
    if (stages & STAGE_HOST) flags |= VK_PIPELINE_STAGE_2_HOST_BIT;
    return flags;
}

VkAccessFlags2 written_by(Stages stages)
{
    VkAccessFlags2 flags = 0;
    if (stages & STAGE_COMPUTE) flags |= VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
    if (stages & STAGE_TRANSFER) flags |= VK_ACCESS_2_TRANSFER_WRITE_BIT;
    return flags;
}

VkAccessFlags2 touched_by(Stages stages)
{
    VkAccessFlags2 flags = written_by(stages);
    if (stages & STAGE_COMPUTE) flags |= VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_SAMPLED_READ_BIT;
    if (stages & STAGE_TRANSFER) flags |= VK_ACCESS_2_TRANSFER_READ_BIT;
    if (stages & STAGE_HOST) flags |= VK_ACCESS_2_HOST_READ_BIT;
    return flags;
}

void record_barrier(VkCommandBuffer commands, const Barrier& barrier)
{
    const VkMemoryBarrier2 memory{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                  .srcStageMask = vulkan_stages(barrier.from),
                                  .srcAccessMask = barrier.memory ? written_by(barrier.from) : 0,
                                  .dstStageMask = vulkan_stages(barrier.to),
                                  .dstAccessMask = barrier.memory ? touched_by(barrier.to) : 0};
    const VkDependencyInfo info{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &memory};
    vkCmdPipelineBarrier2(commands, &info);
}

/// What the host can write of a device's own memory may be 256 MiB in all, for every program.
Placement placement_of(uint64_t bytes)
{
    constexpr uint64_t MOST = uint64_t{4} << 20;
    return bytes <= MOST ? Placement::values : Placement::upload;
}

uint64_t aligned(uint64_t bytes, uint64_t alignment)
{
    return (bytes + alignment - 1) / alignment * alignment;
}

/// To one of two sizes for each power of two: what a brush uploads grows and shrinks by a voxel, and is to find the
/// buffer that the last one left.
uint64_t rounded(uint64_t bytes)
{
    constexpr uint64_t LEAST = 1024;
    const uint64_t power = std::bit_ceil(std::max(bytes, LEAST));
    return bytes <= power / 4 * 3 ? power / 4 * 3 : power;
}

glm::uvec3 groups_for(const glm::uvec3& threads, const glm::uvec3& local)
{
    return (threads + local - 1u) / local;
}

uint64_t threads_of(const glm::uvec3& groups, const glm::uvec3& local)
{
    return uint64_t(groups.x) * groups.y * groups.z * local.x * local.y * local.z;
}

/// What a pass without tiles runs at once: all of it, or slabs across its longest side that take half a submission.
glm::uvec3 slab_of(const glm::uvec3& groups, double all_ms)
{
    glm::uvec3 slab = groups;
    const int longest = groups.x >= groups.y && groups.x >= groups.z ? 0 : groups.y >= groups.z ? 1 : 2;
    const double slabs = std::clamp(std::ceil(all_ms / (0.5 * MAX_SUBMISSION_MS)), 1.0, double(groups[longest]));
    slab[longest] = (groups[longest] + uint32_t(slabs) - 1) / uint32_t(slabs);
    return slab;
}

uint64_t threads_of(const PassData& pass, const Kernel& kernel)
{
    const auto& size = kernel.interface().local_size;
    const glm::uvec3 local(size[0], size[1], size[2]);
    return threads_of(groups_for(pass.threads, local), local);
}

/// Its share of what a part may be at most.
double copy_ms(const std::vector<BufferRegion>& part)
{
    uint64_t bytes = 0;
    for (const BufferRegion& region : part) bytes += region.bytes;
    return COPY_PART_MS * std::max(double(part.size()) / MAX_COPY_REGIONS, double(bytes) / MAX_COPY_BYTES);
}

double copy_ms(const std::vector<ImageRegion>& part)
{
    constexpr double TEXEL_BYTES = 16.0;  // at most
    double bytes = 0.0;
    for (const ImageRegion& region : part)
        bytes += TEXEL_BYTES * double(region.texels.x) * region.texels.y * region.texels.z;
    return COPY_PART_MS * std::min(std::max(double(part.size()) / MAX_COPY_REGIONS, bytes / MAX_COPY_BYTES), 1.0);
}

}  // namespace

/// One graph in flight: everything that lives until the device has finished it.
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
    Storage* work_counters = nullptr;  // where kernels count, if they count much: copied to `counters` at the end
    std::unique_ptr<FrameObjects> objects;
    bool is_timed = false;
    std::vector<size_t> counted_steps;  // per query of statistics
    uint32_t statistics_room = 0;       // queries; 0: none is made
    bool is_in_query = false;
    uint64_t number = 0;                  // of its last submission; 0: none
    std::vector<VkCommandBuffer> chunks;  // one submission each
    double chunk_ms = 0.0;                // estimated, of the last one so far
    VkPipeline in_use = VK_NULL_HANDLE;   // bound there
    std::chrono::steady_clock::time_point started;
    struct Prepared {
        const Kernel* kernel = nullptr;
        VkDescriptorSet set = VK_NULL_HANDLE;
        uint64_t counters_offset = 0;
        uint32_t dispatches = 0;
        uint32_t tiles = 0;
        uint32_t submissions = 0;
        bool is_counted_in_part = false;
    };
    std::vector<Prepared> prepared;             // per step
    std::vector<Memory::Object*> transitioned;  // images that the first chunk takes out of the undefined layout

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
    Storage& take_resource(const FrameGraph::ResourceData& resource)
    {
        if (resource.contents.empty()) return take(resource.name, resource.desc, Placement::device);
        Storage& storage = take(resource.name, resource.desc, placement_of(resource.contents.size()));
        std::ranges::copy(resource.contents, storage.mapped().begin());
        return storage;
    }
    uint32_t object_id(uint32_t resource) const
    {
        const FrameGraph::ResourceData& data = graph.resources()[resource];
        return data.imported ? data.import_id : storages[resource]->import().id;
    }
    Memory::Object& object(uint32_t resource) const { return executor.memory_.object(object_id(resource)); }

    bool counts_work() const;
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
    FrameResult collect();
};

/// Whether a kernel counts what each of its threads does, rather than what hardly ever happens. Then counters are in
/// the device's memory, which kernels add to sooner; otherwise in the host's, which takes no pass to clear or copy.
bool Submission::Frame::counts_work() const
{
    return std::ranges::any_of(compiled.steps, [this](const Step& step) {
        return std::ranges::any_of(pass(step).constants, [](const auto& constant) {
            return constant.first == "COUNT_WORK" && constant.second != 0;
        });
    });
}

void Submission::Frame::prepare()
{
    const auto& resources = graph.resources();
    const uint64_t alignment = executor.device_.traits().limits.minStorageBufferOffsetAlignment;
    storages.resize(resources.size());
    for (uint32_t i = 0; i < resources.size(); ++i) {
        if (!compiled.used[i] || resources[i].imported) continue;
        Storage*& own = storages[compiled.memory_of[i]];
        if (!own) own = &take_resource(resources[compiled.memory_of[i]]);
        storages[i] = own;
    }
    read_backs.resize(graph.read_back_count());

    uint64_t block_bytes = 0, counter_bytes = 0;
    is_timed = options.timestamps && executor.device_.traits().timestamp_bits > 0;
    FrameObjects::Needs needs{.queries = is_timed ? uint32_t(compiled.steps.size()) * 2 : 0};
    constexpr uint32_t QUERIES_OF_STEP = 64;
    if (options.statistics && executor.device_.traits().has_pipeline_statistics)
        statistics_room = needs.statistics = uint32_t(compiled.steps.size()) * QUERIES_OF_STEP;
    prepared.resize(compiled.steps.size());
    for (size_t i = 0; i < compiled.steps.size(); ++i) {
        const PassData& data = pass(compiled.steps[i]);
        if (data.kind == PassData::Kind::read_back)
            read_backs[data.read_back] =
                &take("read back", buffer_desc(resources[data.bindings[0].resource].desc.bytes), Placement::download);
        if (data.kind != PassData::Kind::compute) continue;
        const KernelInterface& interface = executor.kernels_.interface(data.kernel);
        check_bindings(data, interface, resources);
        prepared[i].kernel = &executor.kernels_.get(data.kernel, data.constants);
        for (const auto& [name, bytes] : data.blocks) block_bytes += aligned(bytes.size(), alignment);
        if (interface.slot("counters")) {
            prepared[i].counters_offset = counter_bytes;
            counter_bytes += aligned(COUNTER_BYTES, alignment);
        }
        for (const KernelInterface::Slot& slot : interface.slots) ++needs.descriptors[slot.type];
        ++needs.sets;
    }
    if (block_bytes) blocks = &take("blocks", buffer_desc(block_bytes), placement_of(block_bytes));
    if (counter_bytes) {
        const bool are_copied = counts_work();
        counters = &take("counters", buffer_desc(counter_bytes), Placement::download, !are_copied);
        if (are_copied)
            work_counters = &take("work counters", counters->desc(), Placement::device);
        else
            std::memset(counters->mapped().data(), 0, counters->mapped().size());
    }

    if (executor.idle_objects_.empty()) {
        objects = std::make_unique<FrameObjects>(executor.device_);
    } else {
        objects = std::move(executor.idle_objects_.back());
        executor.idle_objects_.pop_back();
    }
    objects->renew(needs);
    uint64_t block_offset = 0;
    for (size_t i = 0; i < compiled.steps.size(); ++i) {
        if (!prepared[i].kernel) continue;
        prepared[i].set = objects->allocate(prepared[i].kernel->set_layout());
        write_descriptors(pass(compiled.steps[i]), prepared[i], block_offset);
    }
}

void Submission::Frame::write_descriptors(const PassData& data, const Prepared& step, uint64_t& block_offset) const
{
    const std::vector<KernelInterface::Slot>& slots = step.kernel->interface().slots;
    std::vector<VkWriteDescriptorSet> writes;
    std::vector<VkDescriptorBufferInfo> buffers(slots.size());
    std::vector<VkDescriptorImageInfo> images(slots.size());
    for (size_t i = 0; i < slots.size(); ++i) {
        const KernelInterface::Slot& slot = slots[i];
        const auto binding = std::find_if(data.bindings.begin(), data.bindings.end(),
                                          [&](const Binding& b) { return b.name == slot.name; });
        const auto block =
            std::find_if(data.blocks.begin(), data.blocks.end(), [&](const auto& b) { return b.first == slot.name; });
        if (binding != data.bindings.end()) {
            const Memory::Object& bound = object(binding->resource);
            buffers[i] = {bound.buffer, 0, graph.resources()[binding->resource].desc.bytes};
            images[i] = {executor.sampler_, bound.view, VK_IMAGE_LAYOUT_GENERAL};
        } else if (block != data.blocks.end()) {
            std::memcpy(blocks->mapped().data() + block_offset, block->second.data(), block->second.size());
            buffers[i] = {executor.memory_.object(blocks->import().id).buffer, block_offset, block->second.size()};
            block_offset +=
                aligned(block->second.size(), executor.device_.traits().limits.minStorageBufferOffsetAlignment);
        } else {
            const Storage& counted = work_counters ? *work_counters : *counters;
            buffers[i] = {executor.memory_.object(counted.import().id).buffer, step.counters_offset, COUNTER_BYTES};
        }
        const bool is_buffer = slot.type == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        writes.push_back({.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                          .dstSet = step.set,
                          .dstBinding = slot.binding,
                          .descriptorCount = 1,
                          .descriptorType = slot.type,
                          .pImageInfo = is_buffer ? nullptr : &images[i],
                          .pBufferInfo = is_buffer ? &buffers[i] : nullptr});
    }
    vkUpdateDescriptorSets(executor.device_.handle(), uint32_t(writes.size()), writes.data(), 0, nullptr);
}

void Submission::Frame::begin_chunk()
{
    chunks.push_back(objects->begin_commands());
    chunk_ms = 0.0;
    in_use = VK_NULL_HANDLE;
}

void Submission::Frame::end_chunk()
{
    end_statistics();
    SHVR_VK(vkEndCommandBuffer(chunks.back()));
}

/// A query is in one command buffer, so a pass has one in each submission.
void Submission::Frame::begin_statistics(Prepared& state)
{
    if (statistics_room == 0 || is_in_query) return;
    if (counted_steps.size() == statistics_room) {
        state.is_counted_in_part = true;
        return;
    }
    vkCmdBeginQuery(chunks.back(), objects->statistics(), uint32_t(counted_steps.size()), 0);
    counted_steps.push_back(size_t(&state - prepared.data()));
    is_in_query = true;
}

void Submission::Frame::end_statistics()
{
    if (std::exchange(is_in_query, false))
        vkCmdEndQuery(chunks.back(), objects->statistics(), uint32_t(counted_steps.size()) - 1);
}

/// What is recorded next goes into another submission, if this one would take too long with it.
void Submission::Frame::make_room(double ms, Prepared& state)
{
    const bool is_first = state.submissions == 0;
    const bool is_full = chunk_ms > 0.0 && chunk_ms + ms > MAX_SUBMISSION_MS;
    if (is_full) end_chunk(), begin_chunk();
    if (is_first || is_full) ++state.submissions;
    chunk_ms += ms;
}

/// Images are created in an undefined layout and stay in GENERAL from the first frame on that is submitted.
void Submission::Frame::transition_new_images()
{
    std::vector<VkImageMemoryBarrier2> barriers;
    for (uint32_t i = 0; i < storages.size(); ++i) {
        if (!compiled.used[i] || compiled.memory_of[i] != i) continue;
        Memory::Object& image = object(i);
        if (!image.image || image.in_general_layout) continue;
        transitioned.push_back(&image);
        barriers.push_back({.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
                            .dstStageMask = vulkan_stages(STAGE_COMPUTE | STAGE_TRANSFER),
                            .dstAccessMask = touched_by(STAGE_COMPUTE | STAGE_TRANSFER),
                            .oldLayout = VK_IMAGE_LAYOUT_UNDEFINED,
                            .newLayout = VK_IMAGE_LAYOUT_GENERAL,
                            .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                            .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                            .image = image.image,
                            .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}});
    }
    if (barriers.empty()) return;
    const VkDependencyInfo info{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                .imageMemoryBarrierCount = uint32_t(barriers.size()),
                                .pImageMemoryBarriers = barriers.data()};
    vkCmdPipelineBarrier2(chunks.back(), &info);
}

void Submission::Frame::record()
{
    const VkQueryPool queries = objects->queries();
    const auto buffer_of = [this](const Storage& storage) {
        return executor.memory_.object(storage.import().id).buffer;
    };
    begin_chunk();
    transition_new_images();
    if (work_counters) {
        record_barrier(chunks.back(), {STAGE_COMPUTE | STAGE_TRANSFER, STAGE_TRANSFER, true});
        vkCmdFillBuffer(chunks.back(), buffer_of(*work_counters), 0, VK_WHOLE_SIZE, 0);
        record_barrier(chunks.back(), {STAGE_TRANSFER, STAGE_COMPUTE, true});
    }
    for (size_t i = 0; i < compiled.steps.size(); ++i) {
        const Step& step = compiled.steps[i];
        if (options.serialize)
            record_barrier(chunks.back(), {STAGE_COMPUTE | STAGE_TRANSFER, STAGE_COMPUTE | STAGE_TRANSFER, true});
        else if (step.barrier)
            record_barrier(chunks.back(), *step.barrier);
        // Once all that was submitted before has ended: its rest would be taken for this pass's time.
        if (is_timed)
            vkCmdWriteTimestamp2(chunks.back(), VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, queries, uint32_t(2 * i));
        record_pass(step, prepared[i]);
        if (is_timed)
            vkCmdWriteTimestamp2(chunks.back(), VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, queries, uint32_t(2 * i + 1));
    }
    if (work_counters) {
        const VkBufferCopy all{0, 0, counters->desc().bytes};
        record_barrier(chunks.back(), {STAGE_COMPUTE, STAGE_TRANSFER, true});
        vkCmdCopyBuffer(chunks.back(), buffer_of(*work_counters), buffer_of(*counters), 1, &all);
    }
    record_barrier(chunks.back(), {STAGE_COMPUTE | STAGE_TRANSFER, STAGE_HOST, true});
    end_chunk();
}

void Submission::Frame::record_pass(const Step& step, Prepared& state)
{
    const PassData& data = pass(step);
    if (data.kind == PassData::Kind::compute) return record_dispatches(data, state);
    switch (data.kind) {
        case PassData::Kind::compute: break;
        case PassData::Kind::fill: return record_fill(data, state);
        case PassData::Kind::copy_buffer: return record_copy(data, state);
        case PassData::Kind::copy_to_image: return record_copy_to_image(data, state);
        case PassData::Kind::read_back: return record_read_back(data, state);
    }
}

template <class Part, class Copy>
void Submission::Frame::record_parts(Prepared& state, const std::string& name, const std::vector<Part>& parts,
                                     const Copy& copy)
{
    for (const Part& part : parts) {
        make_room(copy_ms(part), state);
        executor.device_.begin_label(chunks.back(), name);
        copy(chunks.back(), part);
        executor.device_.end_label(chunks.back());
    }
}

void Submission::Frame::record_fill(const PassData& data, Prepared& state)
{
    const Memory::Object& buffer = object(data.bindings[0].resource);
    if (buffer.desc.kind == ResourceDesc::Kind::image) return record_clear(data, buffer, state);
    record_parts(
        state, data.name, copy_parts({{0, 0, buffer.desc.bytes}}), [&](VkCommandBuffer commands, const auto& part) {
            const BufferRegion& r = part[0];
            const bool is_last = r.target_offset + r.bytes == buffer.desc.bytes;  // whose size may be no multiple of 4
            vkCmdFillBuffer(commands, buffer.buffer, r.target_offset, is_last ? VK_WHOLE_SIZE : r.bytes,
                            data.fill_value);
        });
}

/// In one command: bricks as regions of their own, ten thousands of them, would take a driver seconds to record.
void Submission::Frame::record_clear(const PassData& data, const Memory::Object& image, Prepared& state)
{
    const uint32_t value = data.fill_value;
    const VkClearColorValue color{.uint32 = {value, value, value, value}};
    const VkImageSubresourceRange whole{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    make_room(COPY_PART_MS, state);
    executor.device_.begin_label(chunks.back(), data.name);
    vkCmdClearColorImage(chunks.back(), image.image, VK_IMAGE_LAYOUT_GENERAL, &color, 1, &whole);
    executor.device_.end_label(chunks.back());
}

void Submission::Frame::record_copy(const PassData& data, Prepared& state)
{
    const VkBuffer from = object(data.bindings[0].resource).buffer, to = object(data.bindings[1].resource).buffer;
    record_parts(state, data.name, copy_parts(data.buffer_regions), [&](VkCommandBuffer commands, const auto& part) {
        std::vector<VkBufferCopy> regions;
        for (const BufferRegion& r : part) regions.push_back({r.source_offset, r.target_offset, r.bytes});
        vkCmdCopyBuffer(commands, from, to, uint32_t(regions.size()), regions.data());
    });
}

void Submission::Frame::record_copy_to_image(const PassData& data, Prepared& state)
{
    const VkBuffer from = object(data.bindings[0].resource).buffer;
    const Memory::Object& to = object(data.bindings[1].resource);
    const auto parts = copy_parts(data.image_regions, to.desc.format);
    record_parts(state, data.name, parts, [&](VkCommandBuffer commands, const auto& part) {
        std::vector<VkBufferImageCopy> regions;
        for (const ImageRegion& r : part)
            regions.push_back({.bufferOffset = r.buffer_offset,
                               .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                               .imageOffset = {int32_t(r.texel.x), int32_t(r.texel.y), int32_t(r.texel.z)},
                               .imageExtent = {r.texels.x, r.texels.y, r.texels.z}});
        vkCmdCopyBufferToImage(commands, from, to.image, VK_IMAGE_LAYOUT_GENERAL, uint32_t(regions.size()),
                               regions.data());
    });
}

void Submission::Frame::record_read_back(const PassData& data, Prepared& state)
{
    const Memory::Object& from = object(data.bindings[0].resource);
    const VkBuffer to = executor.memory_.object(read_backs[data.read_back]->import().id).buffer;
    if (!from.image)
        return record_parts(state, data.name, copy_parts({{0, 0, from.desc.bytes}}),
                            [&](VkCommandBuffer commands, const auto& part) {
                                const VkBufferCopy region{part[0].source_offset, part[0].target_offset, part[0].bytes};
                                vkCmdCopyBuffer(commands, from.buffer, to, 1, &region);
                            });
    const auto parts = copy_parts({{0, glm::uvec3(0), from.desc.texels}}, from.desc.format);
    record_parts(state, data.name, parts, [&](VkCommandBuffer commands, const auto& part) {
        for (const ImageRegion& r : part) {
            const VkBufferImageCopy region{.bufferOffset = r.buffer_offset,
                                           .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                           .imageOffset = {0, 0, int32_t(r.texel.z)},
                                           .imageExtent = {r.texels.x, r.texels.y, r.texels.z}};
            vkCmdCopyImageToBuffer(commands, from.image, VK_IMAGE_LAYOUT_GENERAL, to, 1, &region);
        }
    });
}

void Submission::Frame::record_dispatches(const PassData& data, Prepared& state)
{
    const Kernel& kernel = *state.kernel;
    const auto& size = kernel.interface().local_size;
    const glm::uvec3 local(size[0], size[1], size[2]);
    const glm::uvec3 groups = groups_for(data.threads, local);
    const bool tiled = data.tile.x > 0;
    const auto cost_ms = [&](const glm::uvec3& count) {
        return executor.costs_.ms(data.kernel, threads_of(count, local), tiled);
    };
    const glm::uvec3 tile =
        tiled ? glm::max(groups_for(data.tile, local), glm::uvec3(1)) : slab_of(groups, cost_ms(groups));
    const auto& limit = executor.device_.traits().limits.maxComputeWorkGroupCount;
    if (glm::any(glm::greaterThan(groups, glm::uvec3(limit[0], limit[1], limit[2]))))
        fail("pass '", data.name, "' dispatches ", groups.x, " x ", groups.y, " x ", groups.z,
             " groups; the device allows ", limit[0], " x ", limit[1], " x ", limit[2]);

    glm::uvec3 at;
    for (at.z = 0; at.z < groups.z; at.z += tile.z)
        for (at.y = 0; at.y < groups.y; at.y += tile.y)
            for (at.x = 0; at.x < groups.x; at.x += tile.x) {
                const glm::uvec3 count = glm::min(tile, groups - at);
                make_room(cost_ms(count), state);
                begin_statistics(state);
                ++state.dispatches;
                const VkCommandBuffer commands = chunks.back();
                executor.device_.begin_label(commands, data.name);
                bind(data, state);
                // Validation of hazards does not look at dispatches with a base, so the first tile stands for all.
                if (at == glm::uvec3(0))
                    vkCmdDispatch(commands, count.x, count.y, count.z);
                else
                    vkCmdDispatchBase(commands, at.x, at.y, at.z, count.x, count.y, count.z);
                executor.device_.end_label(commands);
            }
    state.tiles = tiled ? state.dispatches : 1;
    end_statistics();
    in_use = VK_NULL_HANDLE;
}

/// Once in each submission; tiles share what is bound.
void Submission::Frame::bind(const PassData& data, const Prepared& state)
{
    const Kernel& kernel = *state.kernel;
    if (std::exchange(in_use, kernel.pipeline()) == kernel.pipeline()) return;
    const VkCommandBuffer commands = chunks.back();
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.pipeline());
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.layout(), 0, 1, &state.set, 0, nullptr);
    if (!data.push.empty())
        vkCmdPushConstants(commands, kernel.layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0, uint32_t(data.push.size()),
                           data.push.data());
}

void Submission::Frame::submit()
{
    Device& device = executor.device_;
    started = std::chrono::steady_clock::now();
    for (size_t i = 0; i < chunks.size(); ++i) {
        const VkCommandBufferSubmitInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                                 .commandBuffer = chunks[i]};
        const VkSubmitInfo2 info{
            .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2, .commandBufferInfoCount = 1, .pCommandBufferInfos = &commands};
        const bool last = i + 1 == chunks.size();
        const VkResult result = vkQueueSubmit2(device.queue(), 1, &info, last ? objects->fence() : VK_NULL_HANDLE);
        if (result < 0) {
            device.wait_idle_or_lost();
            if (i > 0) note_unknown_states();
            check(result, "vkQueueSubmit2");
        }
        if (i == 0)
            for (Memory::Object* image : transitioned) image->in_general_layout = true;
    }
    number = device.note_submission();
    // Barriers are global, so they also affect imports that no kept pass uses.
    for (uint32_t i = 0; i < compiled.final_states.size(); ++i)
        if (compiled.used[i] || graph.resources()[i].imported) object(i).state = compiled.final_states[i];
}

/// A part of the frame ran, and nobody knows which.
void Submission::Frame::note_unknown_states() const
{
    for (uint32_t i = 0; i < compiled.used.size(); ++i)
        if (compiled.used[i]) object(i).state = UNKNOWN_STATE;
}

bool Submission::Frame::done() const
{
    if (number == 0 || number <= executor.device_.done()) return true;
    // Says what vkGetFenceStatus says, and tells validation that the frame was waited for.
    const VkFence fence = objects->fence();
    const VkResult result = vkWaitForFences(executor.device_.handle(), 1, &fence, VK_TRUE, 0);
    check(result, "vkWaitForFences");
    if (result == VK_SUCCESS) executor.device_.note_done(number);
    return result == VK_SUCCESS;
}

void Submission::Frame::wait() const
{
    if (number == 0) return;
    const VkFence fence = objects->fence();
    SHVR_VK(vkWaitForFences(executor.device_.handle(), 1, &fence, VK_TRUE, UINT64_MAX));
    executor.device_.note_done(number);
}

FrameResult Submission::Frame::collect()
{
    if (number == 0) return {};  // no step, nothing submitted
    wait();
    const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - started;
    FrameResult result{.wall_ms = wall.count()};
    result.read_backs.resize(read_backs.size());
    for (const Step& step : compiled.steps) {
        const PassData& data = pass(step);
        if (data.kind != PassData::Kind::read_back) continue;
        const uint64_t size = graph.resources()[data.bindings[0].resource].desc.bytes;
        const std::span<const std::byte> bytes = read_backs[data.read_back]->mapped().first(size);
        result.read_backs[data.read_back].assign(bytes.begin(), bytes.end());
    }
    const DeviceTraits& traits = executor.device_.traits();
    std::vector<uint64_t> ticks(compiled.steps.size() * 2);
    if (is_timed)
        SHVR_VK(vkGetQueryPoolResults(executor.device_.handle(), objects->queries(), 0, uint32_t(ticks.size()),
                                      ticks.size() * sizeof(uint64_t), ticks.data(), sizeof(uint64_t),
                                      VK_QUERY_RESULT_64_BIT));
    std::vector<uint64_t> invocations(counted_steps.size());
    if (!counted_steps.empty())
        SHVR_VK(vkGetQueryPoolResults(executor.device_.handle(), objects->statistics(), 0, uint32_t(invocations.size()),
                                      invocations.size() * sizeof(uint64_t), invocations.data(), sizeof(uint64_t),
                                      VK_QUERY_RESULT_64_BIT));
    const uint64_t mask = traits.timestamp_bits >= 64 ? ~uint64_t(0) : (uint64_t(1) << traits.timestamp_bits) - 1;
    const auto milliseconds = [&](uint64_t from, uint64_t to) {
        return double((to - from) & mask) * double(traits.nanoseconds_per_tick) * 1e-6;
    };
    if (is_timed) result.gpu_ms = milliseconds(ticks.front(), ticks.back());
    for (size_t i = 0; i < compiled.steps.size(); ++i) {
        const PassData& data = pass(compiled.steps[i]);
        PassReport report{.name = data.name, .kernel = data.kernel};
        report.dispatches = prepared[i].dispatches;
        report.tiles = prepared[i].tiles;
        report.submissions = prepared[i].submissions;
        if (is_timed) {
            report.timed = true;
            report.start_ms = milliseconds(ticks[0], ticks[2 * i]);
            report.gpu_ms = milliseconds(ticks[2 * i], ticks[2 * i + 1]);
        }
        for (size_t query = 0; query < counted_steps.size() && !prepared[i].is_counted_in_part; ++query)
            if (counted_steps[query] == i) report.invocations = report.invocations.value_or(0) + invocations[query];
        // On a device without timestamps a pass takes no longer than all of them, and those before, did on the host's
        // clock. A frame that merely was not timed teaches nothing: it may have waited long, in the queue and after.
        if (prepared[i].kernel && (is_timed || traits.timestamp_bits == 0))
            executor.costs_.learn(data.kernel, threads_of(data, *prepared[i].kernel),
                                  is_timed ? report.gpu_ms : result.wall_ms);
        for (const Binding& binding : data.bindings) report.bytes += graph.resources()[binding.resource].desc.bytes;
        if (const auto& barrier = compiled.steps[i].barrier)
            report.barrier = names_of(barrier->from) + " -> " + names_of(barrier->to);
        if (prepared[i].kernel && prepared[i].kernel->interface().slot("counters")) {
            report.counters.resize(COUNTERS);
            std::memcpy(report.counters.data(), counters->mapped().data() + prepared[i].counters_offset, COUNTER_BYTES);
        }
        result.passes.push_back(std::move(report));
    }
    return result;
}

Executor::Executor(Device& device, Memory& memory) : device_(device), memory_(memory), kernels_(device)
{
    const VkSamplerCreateInfo sampler{.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                      .magFilter = VK_FILTER_LINEAR,
                                      .minFilter = VK_FILTER_LINEAR,
                                      .mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST,
                                      .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                      .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                      .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE};
    SHVR_VK(vkCreateSampler(device.handle(), &sampler, nullptr, &sampler_));
    device.set_name(VK_OBJECT_TYPE_SAMPLER, reinterpret_cast<uint64_t>(sampler_), "linear clamp");
    memory.free_idle_by([this] { trim(); });
}

Executor::~Executor()
{
    memory_.free_idle_by({});
    device_.wait_idle_or_lost();
    vkDestroySampler(device_.handle(), sampler_, nullptr);
}

Storage& Executor::take_transient(const std::string& name, const ResourceDesc& wanted, Placement placement,
                                  bool is_counted_in)
{
    ResourceDesc desc = wanted;
    if (placement != Placement::device) desc.bytes = rounded(desc.bytes);
    for (const auto& transient : transients_) {
        if (transient->taken || transient->placement != placement || !(transient->desc == desc)) continue;
        // Kernels count where no copy has written: validation (1.3.239) does not always know that the copy's frame was
        // waited for, and tells of a read after its write.
        if (transient->is_counted_in != is_counted_in) continue;
        transient->taken = true;
        transient->last_run = runs_;
        return transient->storage;
    }
    transients_.push_back(std::make_unique<Transient>(
        Transient{desc, placement, runs_, true, is_counted_in, memory_.create(name, desc, placement)}));
    return transients_.back()->storage;
}

void Executor::trim(uint64_t runs)
{
    std::erase_if(transients_, [&](const auto& t) {
        if (t->taken || t->last_run + runs > runs_) return false;
        t->storage.reset_idle();  // the frame that last used it is done
        return true;
    });
}

Submission Executor::submit(FrameGraph graph, const Options& options)
{
    constexpr uint64_t RUNS_KEPT = 512;  // sizes change with brushes and windows: unused ones are freed
    ++runs_;
    trim(RUNS_KEPT);
    auto frame = std::make_unique<Submission::Frame>(*this, std::move(graph), options);
    if (!frame->compiled.steps.empty()) {
        frame->prepare();
        frame->record();
        frame->submit();
    }
    frame->graph.note_submitted();
    return Submission(std::move(frame));
}

Submission::Submission() = default;
Submission::~Submission() = default;
Submission::Submission(Submission&&) noexcept = default;
Submission& Submission::operator=(Submission&&) noexcept = default;
Submission::Submission(std::unique_ptr<Frame> frame) : frame_(std::move(frame)) {}

bool Submission::done() const
{
    SHVR_CHECK(frame_ != nullptr);
    return frame_->done();
}

void Submission::wait() const
{
    SHVR_CHECK(frame_ != nullptr);
    frame_->wait();
}

FrameResult Submission::finish()
{
    SHVR_CHECK(frame_ != nullptr);
    FrameResult result = frame_->collect();
    frame_.reset();
    return result;
}

const FrameGraph& Submission::graph() const
{
    SHVR_CHECK(frame_ != nullptr);
    return frame_->graph;
}

}  // namespace shvr::gpu

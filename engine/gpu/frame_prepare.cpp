// Acquires memory, kernels and descriptors for a graph before its commands are recorded (frame_in_flight.h).

#include <algorithm>
#include <cstring>

#include "engine/gpu/frame_in_flight.h"
#include "engine/gpu/live_trace.h"

namespace shvr::gpu {

namespace {

/// Returns an upload's placement. Host-writable device memory, often only 256 MiB, is for small uploads.
Placement placement_of(uint64_t bytes)
{
    constexpr uint64_t MOST = uint64_t{4} << 20;
    return bytes <= MOST ? Placement::values : Placement::upload;
}

/// What a kernel reads of words that it gets by address, in scalar layout.
struct AddressBlock {
    VkDeviceAddress address;
    glm::uvec3 words;
    uint32_t unused = 0;
};

}  // namespace

/// Whether any kernel counts the work of every thread instead of rare events only. If so, the counters are in device
/// memory, where atomic additions are faster. Otherwise they are in host memory and need no clear or copy.
bool Submission::Frame::counts_work() const
{
    return std::ranges::any_of(compiled.steps, [this](const Step& step) {
        return std::ranges::any_of(pass(step).constants, [](const auto& constant) {
            return constant.first == "COUNT_WORK" && constant.second != 0;
        });
    });
}

Storage& Submission::Frame::take_resource(const FrameGraph::ResourceData& resource)
{
    if (resource.contents.empty()) return take(resource.name, resource.desc, Placement::device);
    Storage& storage = take(resource.name, resource.desc, placement_of(resource.contents.size()));
    std::ranges::copy(resource.contents, storage.mapped().begin());
    return storage;
}

/// `are_copied`: counters are in device memory and are copied to the host; otherwise they are in host memory.
void Submission::Frame::take_counters(uint64_t bytes, bool are_copied)
{
    counters = &take("counters", buffer_desc(bytes), Placement::download, !are_copied);
    if (are_copied)
        work_counters = &take("work counters", counters->desc(), Placement::device);
    else
        std::memset(counters->mapped().data(), 0, counters->mapped().size());
}

void Submission::Frame::take_objects()
{
    if (executor.idle_objects_.empty()) {
        objects = std::make_unique<FrameObjects>(executor.device_);
    } else {
        objects = std::move(executor.idle_objects_.back());
        executor.idle_objects_.pop_back();
    }
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

    const bool are_copied = counts_work();
    counter_bytes = are_copied ? COUNTER_ROWS * COUNTER_ROW_BYTES : COUNTER_ROW_BYTES;
    uint64_t block_bytes = 0, all_counter_bytes = 0;
    is_timed = (options.timestamps || IS_TRACED) && executor.device_.traits().timestamp_bits > 0;
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
        for (const Binding& binding : data.bindings)
            if (resources[binding.resource].desc.by_address && interface.slot(binding.name))
                block_bytes += aligned(sizeof(AddressBlock), alignment);
        if (interface.slot("counters")) {
            prepared[i].counters_offset = all_counter_bytes;
            all_counter_bytes += aligned(counter_bytes, alignment);
        }
        for (const KernelInterface::Slot& slot : interface.slots) ++needs.descriptors[slot.type];
        ++needs.sets;
    }
    if (block_bytes) blocks = &take("blocks", buffer_desc(block_bytes), placement_of(block_bytes));
    if (all_counter_bytes) take_counters(all_counter_bytes, are_copied);

    take_objects();
    objects->renew(needs);
    uint64_t block_offset = 0;
    for (size_t i = 0; i < compiled.steps.size(); ++i) {
        if (!prepared[i].kernel) continue;
        const auto began = std::chrono::steady_clock::now();
        prepared[i].set = objects->allocate(prepared[i].kernel->set_layout());
        write_descriptors(pass(compiled.steps[i]), prepared[i], block_offset);
        prepared[i].recording = std::chrono::steady_clock::now() - began;
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
        const auto add_block = [&](std::span<const std::byte> bytes) {
            std::memcpy(blocks->mapped().data() + block_offset, bytes.data(), bytes.size());
            buffers[i] = {executor.memory_.object(blocks->import().id).buffer, block_offset, bytes.size()};
            block_offset += aligned(bytes.size(), executor.device_.traits().limits.minStorageBufferOffsetAlignment);
        };
        const auto block =
            std::find_if(data.blocks.begin(), data.blocks.end(), [&](const auto& b) { return b.first == slot.name; });
        if (slot.by_address && binding != data.bindings.end()) {
            const AddressBlock at{object(binding->resource).address, graph.resources()[binding->resource].desc.texels};
            add_block(std::as_bytes(std::span(&at, 1)));
        } else if (binding != data.bindings.end()) {
            const Memory::Object& bound = object(binding->resource);
            buffers[i] = {bound.buffer, 0, graph.resources()[binding->resource].desc.bytes};
            images[i] = {executor.sampler_, bound.view, VK_IMAGE_LAYOUT_GENERAL};
        } else if (block != data.blocks.end()) {
            add_block(block->second);
        } else {
            const Storage& counted = work_counters ? *work_counters : *counters;
            buffers[i] = {executor.memory_.object(counted.import().id).buffer, step.counters_offset, counter_bytes};
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

}  // namespace shvr::gpu

// Records a graph's commands (frame_in_flight.h): barriers and dispatches. Decides where each submission ends.

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/gpu/frame_in_flight.h"
#include "engine/gpu/live_trace.h"

namespace shvr::gpu {

namespace {

VkAccessFlags2 written_by(Stages stages)
{
    VkAccessFlags2 flags = 0;
    if (stages & STAGE_COMPUTE) flags |= VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
    if (stages & STAGE_TRANSFER) flags |= VK_ACCESS_2_TRANSFER_WRITE_BIT;
    return flags;
}

}  // namespace

VkPipelineStageFlags2 vulkan_stages(Stages stages)
{
    VkPipelineStageFlags2 flags = 0;
    if (stages & STAGE_COMPUTE) flags |= VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
    if (stages & STAGE_TRANSFER) flags |= VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
    if (stages & STAGE_HOST) flags |= VK_PIPELINE_STAGE_2_HOST_BIT;
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

uint64_t threads_of(const glm::uvec3& groups, const glm::uvec3& local)
{
    return uint64_t(groups.x) * groups.y * groups.z * local.x * local.y * local.z;
}

uint64_t threads_of(const PassData& pass, const Kernel& kernel)
{
    const auto& size = kernel.interface().local_size;
    const glm::uvec3 local(size[0], size[1], size[2]);
    return threads_of(groups_for(pass.threads, local), local);
}

namespace {

/// Returns the number of groups that a pass without tiles dispatches at once: all of them, or a slab across the longest
/// side that takes half a submission's time.
glm::uvec3 slab_of(const glm::uvec3& groups, double all_ms)
{
    glm::uvec3 slab = groups;
    const int longest = groups.x >= groups.y && groups.x >= groups.z ? 0 : groups.y >= groups.z ? 1 : 2;
    const double slabs = std::clamp(std::ceil(all_ms / (0.5 * MAX_SUBMISSION_MS)), 1.0, double(groups[longest]));
    slab[longest] = (groups[longest] + uint32_t(slabs) - 1) / uint32_t(slabs);
    return slab;
}

}  // namespace

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

/// Begins a statistics query. A query cannot span command buffers, so a pass has one query per submission.
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

/// Starts another submission if adding the next command to this one would make it too long.
void Submission::Frame::make_room(double ms, Prepared& state)
{
    const bool is_first = state.submissions == 0;
    const bool is_full = chunk_ms > 0.0 && chunk_ms + ms > MAX_SUBMISSION_MS;
    if (is_full) end_chunk(), begin_chunk();
    if (is_first || is_full) ++state.submissions;
    chunk_ms += ms;
}

/// Moves new images from the undefined layout to GENERAL, in which they stay from the first submitted frame on.
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
        prepared[i].recorded = std::chrono::steady_clock::now();
        if (options.serialize)
            record_barrier(chunks.back(), {STAGE_COMPUTE | STAGE_TRANSFER, STAGE_COMPUTE | STAGE_TRANSFER, true});
        else if (step.barrier)
            record_barrier(chunks.back(), *step.barrier);
        // The device writes this timestamp once all earlier submissions are complete; otherwise, the time until then
        // would count as part of this pass.
        if (is_timed)
            vkCmdWriteTimestamp2(chunks.back(), VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, queries, uint32_t(2 * i));
        record_pass(step, prepared[i]);
        if (is_timed)
            vkCmdWriteTimestamp2(chunks.back(), VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, queries, uint32_t(2 * i + 1));
        prepared[i].recording += std::chrono::steady_clock::now() - prepared[i].recorded;
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
    const TraceSpan span(data.name);
    if (data.kind == PassData::Kind::compute) return record_dispatches(data, state);
    switch (data.kind) {
        case PassData::Kind::compute: break;
        case PassData::Kind::fill: return record_fill(data, state);
        case PassData::Kind::copy_buffer: return record_copy(data, state);
        case PassData::Kind::copy_to_image: return record_copy_to_image(data, state);
        case PassData::Kind::read_back: return record_read_back(data, state);
    }
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
                // The validation layer tracks each image as a whole, so it reports hazards although dispatches write
                // separate texels. It ignores dispatches with a base, so only the first tile is validated.
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

/// Binds a pass's pipeline and resources unless they are bound already: all tiles of a pass share one binding.
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

}  // namespace shvr::gpu

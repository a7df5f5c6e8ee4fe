// Copies, fills and read-backs of a graph (frame_in_flight.h), split into parts that keep submissions short.

#include <algorithm>

#include "engine/gpu/frame_in_flight.h"
#include "engine/graph/copy_parts.h"

namespace shvr::gpu {

namespace {

/// Estimates a part's time from COPY_PART_MS, the time of a part of maximum size, in proportion to the part's size.
double copy_ms(const std::vector<BufferRegion>& part)
{
    uint64_t bytes = 0;
    for (const BufferRegion& region : part) bytes += region.bytes;
    return COPY_PART_MS * std::max(double(part.size()) / MAX_COPY_REGIONS, double(bytes) / MAX_COPY_BYTES);
}

double copy_ms(const std::vector<ImageRegion>& part)
{
    constexpr double TEXEL_BYTES = 16.0;  // upper bound
    double bytes = 0.0;
    for (const ImageRegion& region : part)
        bytes += TEXEL_BYTES * double(region.texels.x) * region.texels.y * region.texels.z;
    return COPY_PART_MS * std::min(std::max(double(part.size()) / MAX_COPY_REGIONS, bytes / MAX_COPY_BYTES), 1.0);
}

}  // namespace

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
            const bool is_last = r.target_offset + r.bytes == buffer.desc.bytes;  // its size may not be a multiple of 4
            vkCmdFillBuffer(commands, buffer.buffer, r.target_offset, is_last ? VK_WHOLE_SIZE : r.bytes,
                            data.fill_value);
        });
}

/// Clears an image with one command; separate regions for tens of thousands of bricks can take seconds to record.
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

}  // namespace shvr::gpu

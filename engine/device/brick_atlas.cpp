#include "engine/device/brick_atlas.h"

#include <cstring>

#include "engine/device/device_volume.h"

namespace shvr {

uint64_t BrickAtlas::slot_bytes()
{
    return BrickTexels::CODE_BYTES + BrickTexels::CELLS * (sizeof(uint32_t) + sizeof(uint8_t));
}

BrickAtlas::BrickAtlas(gpu::Executor& executor, gpu::Memory& memory, uint64_t slots, bool filtered)
    : executor_(executor), filtered_(filtered)
{
    const gpu::DeviceTraits& traits = memory.device().traits();
    slots_ = atlas_layout(slots, gpu::BRICK_TEXELS, traits.limits.maxImageDimension3D, traits.is_cpu);
    const glm::uvec3 texels = slots_ * gpu::BRICK_TEXELS;
    const auto create_image = [&](const char* name, const ResourceDesc& desc) {
        return memory.create(name, desc, gpu::Placement::device, "the volume");
    };
    codes_ = create_image("atlas", filtered ? image_desc(Format::r16_unorm, texels)
                                            : image_desc(Format::r32_uint, texels / glm::uvec3(2, 1, 1)));
    cell_ranges_ = create_image("cell ranges", image_desc(Format::r32_uint, slots_ * gpu::BRICK_CELLS));
    for (Staging& staging : staging_)
        staging.bytes =
            memory.create("brick staging", buffer_desc(BATCH * (BrickTexels::CODE_BYTES + BrickTexels::RANGE_BYTES)),
                          gpu::Placement::upload, "the transfer of the volume");
}

uint32_t BrickAtlas::packed(uint32_t slot) const
{
    return slot_at(slot, slots_);
}

void BrickAtlas::stage(uint32_t slot, const BrickTexels& texels)
{
    if (staged_.size() == BATCH) flush();  // which failed when the last one came
    Staging& staging = staging_[filling_];
    if (staging.copy) static_cast<void>(staging.copy.finish());
    std::byte* bytes = staging.bytes.mapped().data();
    std::memcpy(bytes + staged_.size() * BrickTexels::CODE_BYTES, texels.codes.data(), BrickTexels::CODE_BYTES);
    std::memcpy(bytes + BATCH * BrickTexels::CODE_BYTES + staged_.size() * BrickTexels::RANGE_BYTES,
                texels.cell_ranges.data(), BrickTexels::RANGE_BYTES);
    staged_.push_back(slot);
    if (staged_.size() == BATCH) flush();
}

void BrickAtlas::flush()
{
    if (staged_.empty()) return;
    const glm::uvec3 codes_per_texel(filtered_ ? 1 : 2, 1, 1);
    std::vector<ImageRegion> code_regions, cell_regions;
    for (size_t i = 0; i < staged_.size(); ++i) {
        const glm::uvec3 slot = gpu::unpack_slot(packed(staged_[i]));
        code_regions.push_back({i * BrickTexels::CODE_BYTES, gpu::BRICK_TEXELS * slot / codes_per_texel,
                                glm::uvec3(gpu::BRICK_TEXELS) / codes_per_texel});
        cell_regions.push_back({BATCH * BrickTexels::CODE_BYTES + i * BrickTexels::RANGE_BYTES, gpu::BRICK_CELLS * slot,
                                glm::uvec3(gpu::BRICK_CELLS)});
    }
    FrameGraph graph;
    const Resource staged = graph.import("brick staging", staging_[filling_].bytes.import());
    static_cast<void>(graph.copy_to_image(staged, import_codes(graph), std::move(code_regions), "upload bricks"));
    static_cast<void>(
        graph.copy_to_image(staged, import_cell_ranges(graph), std::move(cell_regions), "upload cell ranges"));
    staging_[filling_].copy = executor_.submit(std::move(graph), {.timestamps = false});
    filling_ = 1 - filling_;
    upload_count_ += staged_.size();
    staged_.clear();
}

}  // namespace shvr

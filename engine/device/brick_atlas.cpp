#include "engine/device/brick_atlas.h"

namespace shvr {

uint64_t BrickAtlas::slot_bytes(AtlasCodes codes)
{
    return slot_code_bytes(codes) + BrickTexels::CELLS * (sizeof(uint32_t) + sizeof(uint8_t));
}

BrickAtlas::BrickAtlas(gpu::Executor& executor, gpu::Memory& memory, const StackedLayout& layout, AtlasCodes codes)
    : slots_(layout.all()),
      rows_(layout.slots.z),
      slot_codes_(gpu::slot_codes(code_bytes(codes))),
      uploads_(executor, memory, BATCH, codes)
{
    const auto create_image = [&](const char* name, const ResourceDesc& desc) {
        return memory.create(name, desc, gpu::Placement::device, "the volume");
    };
    for (uint32_t image = 0; image < layout.images; ++image)
        codes_.push_back(create_image("atlas", atlas_desc(codes, layout.slots * slot_codes_, layout.by_address)));
    cell_ranges_ = create_image("cell ranges", image_desc(Format::r32_uint, slots_ * gpu::BRICK_CELLS));
}

uint32_t BrickAtlas::packed(uint32_t slot) const
{
    return slot_at(slot, slots_);
}

void BrickAtlas::stage(uint32_t slot, const BrickTexels& texels)
{
    const glm::uvec3 at = gpu::unpack_slot(packed(slot));
    uploads_.stage({.codes = &codes_[at.z / rows_],
                    .code = slot_codes_ * glm::uvec3(at.x, at.y, at.z % rows_),
                    .begin = -glm::ivec3(gpu::BRICK_APRON),
                    .end = glm::ivec3(slot_codes_ - gpu::BRICK_APRON),
                    .cells = &cell_ranges_,
                    .cell = gpu::BRICK_CELLS * at},
                   texels);
}

void BrickAtlas::import_codes(FrameGraph& graph, VolumeBinding& volume) const
{
    volume.by_address = codes_.front().desc().by_address;
    volume.atlas = graph.import("atlas", codes_.front().import());
    for (size_t image = 1; image < codes_.size(); ++image)
        volume.more_atlases.push_back(graph.import("atlas", codes_[image].import()));
}

}  // namespace shvr

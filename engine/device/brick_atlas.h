#pragma once
// Brick slots in device memory: the codes of each brick, apron included, and the value ranges of its cells. The codes
// are stored in one image, in several if one image cannot hold enough, or in a buffer (StackedLayout). The owner
// assigns bricks to slots (paged_volume.h). Used only by the thread that owns the device.

#include <vector>

#include "engine/device/brick_uploads.h"
#include "engine/device/device_volume.h"

namespace shvr {

class BrickAtlas {
public:
    static constexpr size_t BATCH = BrickUploads::BATCH;
    /// Device bytes per slot, including the leap distances of the slot's cells.
    static uint64_t slot_bytes(AtlasCodes codes);

    /// Fails as gpu::Memory::create does.
    BrickAtlas(gpu::Executor& executor, gpu::Memory& memory, const StackedLayout& layout, AtlasCodes codes);

    const glm::uvec3& slots() const { return slots_; }
    /// Slot 0 is never used.
    uint32_t slot_count() const { return slots_.x * slots_.y * slots_.z; }
    /// The address of a slot, packed into one word as kernels read it.
    uint32_t packed(uint32_t slot) const;

    /// Stages a brick for upload to its slot with the next batch. May wait until the batch before the last is uploaded.
    void stage(uint32_t slot, const BrickTexels& texels);
    void flush() { uploads_.flush(); }
    /// Bricks uploaded so far.
    uint64_t uploads() const { return uploads_.uploads(); }
    /// Number of images that hold the codes.
    uint32_t images() const { return uint32_t(codes_.size()); }

    void import_codes(FrameGraph& graph, VolumeBinding& volume) const;
    Resource import_cell_ranges(FrameGraph& graph) const { return graph.import("cell ranges", cell_ranges_.import()); }

private:
    glm::uvec3 slots_;
    uint32_t rows_;  ///< slots of one image along z
    glm::uvec3 slot_codes_;
    std::vector<gpu::Storage> codes_;
    gpu::Storage cell_ranges_;
    BrickUploads uploads_;
};

}  // namespace shvr

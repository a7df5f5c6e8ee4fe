#pragma once
// Bricks in slots on the device: their codes, aprons included, and the ranges of their cells. The owner decides which
// brick goes to which slot (paged_volume.h). Bricks are uploaded in batches of BATCH: one batch is filled while the
// device copies the other. One thread, the one that owns the device.

#include <array>
#include <vector>

#include "engine/bricks/brick_store.h"
#include "engine/gpu/executor.h"
#include "shaders/bricks.h"

namespace shvr {

class BrickAtlas {
public:
    static constexpr size_t BATCH = 32;  ///< twice 2.5 MiB of staging
    /// Device bytes per slot, including the leap distances of its cells.
    static uint64_t slot_bytes();

    /// `filtered`: in a format that the device can filter. Fails as gpu::Memory::create does.
    BrickAtlas(gpu::Executor& executor, gpu::Memory& memory, uint64_t slots, bool filtered);

    const glm::uvec3& slots() const { return slots_; }
    /// Slot 0 is never used.
    uint32_t slot_count() const { return slots_.x * slots_.y * slots_.z; }
    /// The address of that slot as kernels use it.
    uint32_t packed(uint32_t slot) const;

    /// Uploads a brick to its slot with the next batch; may wait for the batch before the last one.
    void stage(uint32_t slot, const BrickTexels& texels);
    void flush();
    /// Bricks uploaded so far.
    uint64_t uploads() const { return upload_count_; }

    Resource import_codes(FrameGraph& graph) const { return graph.import("atlas", codes_.import()); }
    Resource import_cell_ranges(FrameGraph& graph) const { return graph.import("cell ranges", cell_ranges_.import()); }

private:
    struct Staging {
        gpu::Storage bytes;  ///< codes of all bricks, then their ranges
        gpu::Submission copy;
    };
    gpu::Executor& executor_;
    bool filtered_;
    glm::uvec3 slots_;
    gpu::Storage codes_, cell_ranges_;
    std::array<Staging, 2> staging_;
    size_t filling_ = 0;            ///< of staging_
    std::vector<uint32_t> staged_;  ///< slots of the bricks in that buffer
    uint64_t upload_count_ = 0;
};

}  // namespace shvr

#pragma once
// Brings bricks to the device in batches: one is filled while the device takes the other, so that cutting, copying on
// the host and copying to the device overlap. A CPU copies each brick's rows; GPUs, for some of which every slice of a
// copy is a dispatch, unpack a batch by one kernel (passes/brick_unpack.h). One thread, the one that owns the device.

#include <array>
#include <vector>

#include "engine/bricks/brick_builder.h"
#include "engine/gpu/executor.h"
#include "engine/passes/brick_unpack.h"

namespace shvr {

class BrickUploads {
public:
    static constexpr size_t BATCH = 32;  ///< twice 2.5 MiB of staging

    /// Of `bricks` at most in a batch.
    BrickUploads(gpu::Executor& executor, gpu::Memory& memory, uint64_t bricks, AtlasCodes codes);

    /// Where a brick goes: its codes, and the ranges of its cells. The images must outlive the copies.
    struct Target {
        const gpu::Storage* codes;
        glm::uvec3 code;  ///< the place of the first one
        /// Which ones: in voxels from the brick's first. Those beyond its apron repeat the apron's.
        glm::ivec3 begin, end;
        const gpu::Storage* cells;
        glm::uvec3 cell;
    };
    /// Uploads it with the next batch; may wait for the batch before the last one.
    void stage(const Target& target, const BrickTexels& texels);
    /// Begins to upload what was staged.
    void flush();
    /// Waits until all that was flushed is there.
    void finish();
    /// Whether nothing is under way.
    bool is_idle() const;
    size_t batch() const { return batch_; }
    uint64_t uploads() const { return upload_count_; }

private:
    struct Staging {
        gpu::Storage bytes;  ///< codes of all bricks, as they lie in a slot, then their ranges
        gpu::Submission copy;
    };
    /// Where the codes and the ranges of a brick of a batch are staged.
    uint64_t codes_at(uint64_t brick) const
    {
        return brick * slot_code_bytes(codes_);  // the most that go to any place
    }
    uint64_t ranges_at(uint64_t brick) const { return codes_at(batch_) + brick * BrickTexels::RANGE_BYTES; }
    glm::uvec3 extent_of(uint32_t brick) const { return {targets_[brick].end - targets_[brick].begin}; }
    void add_copies(FrameGraph& graph, Resource staged) const;
    void add_kernels(FrameGraph& graph, Resource staged) const;

    gpu::Executor& executor_;
    AtlasCodes codes_;
    bool unpacks_;
    size_t batch_;
    std::array<Staging, 2> staging_;
    size_t filling_ = 0;           ///< of staging_
    std::vector<Target> targets_;  ///< of the bricks in that buffer
    uint64_t upload_count_ = 0;
};

}  // namespace shvr

#pragma once
// Uploads bricks to the device in double-buffered batches: the host fills one batch while the device copies the other,
// so cutting, host copies and device copies overlap. On CPU devices each brick is copied row by row. On GPUs one kernel
// unpacks a batch (passes/brick_unpack.h), since some GPU drivers run a dispatch for every slice of a copy; so does it
// where codes are in a buffer. Used only by the thread that owns the device.

#include <array>
#include <vector>

#include "engine/bricks/brick_builder.h"
#include "engine/gpu/executor.h"
#include "engine/passes/brick_unpack.h"

namespace shvr {

class BrickUploads {
public:
    static constexpr size_t BATCH = 32;  ///< bricks per batch; each of the two buffers takes 2.5 MiB

    /// `bricks`: upper bound on the number of bricks in a batch.
    BrickUploads(gpu::Executor& executor, gpu::Memory& memory, uint64_t bricks, AtlasCodes codes);

    /// Where a brick is written: its codes and the ranges of its cells. The images must outlive the copies.
    struct Target {
        const gpu::Storage* codes;
        glm::uvec3 code;  ///< texel of its first code
        /// The box of codes to write, in voxels relative to the brick's first voxel. Codes outside the apron repeat the
        /// nearest code of the apron.
        glm::ivec3 begin, end;
        const gpu::Storage* cells;
        glm::uvec3 cell;
    };
    /// Adds the brick to the current batch. May wait until the device has copied the batch before the previous one.
    void stage(const Target& target, const BrickTexels& texels);
    /// Begins to upload the staged bricks.
    void flush();
    /// Waits until all flushed batches are on the device.
    void finish();
    /// Whether no upload is in flight.
    bool is_idle() const;
    size_t batch() const { return batch_; }
    uint64_t uploads() const { return upload_count_; }

private:
    struct Staging {
        gpu::Storage bytes;  ///< codes of all bricks, laid out as in a slot, followed by the ranges
        gpu::Submission copy;
    };
    /// Byte offsets of a brick's codes and ranges in the staging buffer of a batch.
    uint64_t codes_at(uint64_t brick) const
    {
        return brick * slot_code_bytes(codes_);  // no copy takes more codes than a slot has
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
    size_t filling_ = 0;           ///< index into staging_
    std::vector<Target> targets_;  ///< targets of the bricks in the buffer being filled
    uint64_t upload_count_ = 0;
};

}  // namespace shvr

#pragma once
// Presents sparse bricks as a volume source that lists its stored blocks. Any thread may read it.

#include <algorithm>
#include <cstring>
#include <utility>

#include "engine/annotation/sparse_bricks.h"
#include "engine/base/error.h"
#include "engine/volume/source.h"

namespace shvr {

template <class Value>
class SparseSource : public VolumeSource {
public:
    /// `info` states the size of `bricks` and a type as wide as `Value`. `bricks` must outlive this object, unchanged.
    SparseSource(const SparseBricks<Value>& bricks, VolumeInfo info) : VolumeSource(std::move(info)), bricks_(bricks)
    {
        SHVR_CHECK(bricks.size() == this->info().size && bytes_of(this->info().type) == sizeof(Value));
    }

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        std::ranges::fill(voxels, std::byte{0});
        const Size3 first = box.lower / BRICK_SIDE, end = brick_grid(box.upper);
        Size3 at;
        for (at.z = first.z; at.z < end.z; ++at.z)
            for (at.y = first.y; at.y < end.y; ++at.y)
                for (at.x = first.x; at.x < end.x; ++at.x)
                    if (const auto& brick = bricks_.brick(index_of(at, bricks_.brick_counts())))
                        copy(*brick, BRICK_SIDE * at, box, voxels);
    }

    std::optional<StoredBlocks> stored_blocks(int level, int64_t most) const override
    {
        SHVR_CHECK(level == 0, level);
        StoredBlocks stored{.block = Size3(BRICK_SIDE)};
        for (const int64_t brick : bricks_.painted_bricks()) stored.blocks.push_back(bricks_.position_of(brick));
        if (int64_t(stored.blocks.size()) > most) return std::nullopt;
        return stored;
    }

protected:
    /// Converts a value of a brick to a value of the volume; 0 stays 0.
    virtual Value shown(Value value) const { return value; }

private:
    void copy(const typename SparseBricks<Value>::Brick& brick, const Size3& corner, const VoxelBox& box,
              std::span<std::byte> voxels) const
    {
        const Size3 lower = glm::max(box.lower, corner), upper = glm::min(box.upper, corner + BRICK_SIDE);
        std::array<Value, size_t{BRICK_SIDE}> row{};
        for (int64_t z = lower.z; z < upper.z; ++z)
            for (int64_t y = lower.y; y < upper.y; ++y) {
                const auto width = size_t(upper.x - lower.x);
                const Value* const from = brick.data() + index_in_brick(Size3(lower.x, y, z));
                std::transform(from, from + width, row.begin(), [&](Value value) { return shown(value); });
                const int64_t to = index_of(Size3(lower.x, y, z) - box.lower, box.size());
                std::memcpy(voxels.data() + size_t(to) * sizeof(Value), row.data(), width * sizeof(Value));
            }
    }

    const SparseBricks<Value>& bricks_;
};

}  // namespace shvr

#pragma once
// Ranges of the bricks of a level of which only some chunks are made. Stores a range only if it differs from that of a
// brick in which nothing is stored.

#include <algorithm>
#include <cmath>
#include <mutex>
#include <vector>

#include "engine/projects/levels/import_ranges.h"
#include "engine/projects/levels/import_state.h"
#include "engine/volume/grid.h"

namespace shvr {

/// Different cubes may be added at the same time, each cube once.
template <class T>
class SparseRanges {
public:
    struct Brick {
        uint64_t number = 0;
        int64_t voxels = 0;  ///< number of added voxels in the brick and next to it
        ImportRange<T> range{};
    };

    /// `size`: size of the level. `rest`: the range of voxels of chunks that are not made.
    SparseRanges(const Size3& size, const ImportRange<T>& rest)
        : size_(size), counts_(size_of_level(size, 5)), rest_(rest)
    {}

    void add(const ImportCube<T>& cube, const Size3& origin)
    {
        const std::vector<BrickPart<T>> parts = brick_parts(cube, origin, counts_);
        const std::scoped_lock lock(mutex_);
        for (const BrickPart<T>& part : parts)
            bricks_.push_back({.number = uint64_t(part.brick), .voxels = part.voxels, .range = part.range});
        // Merges once the number of entries has doubled: sorting then costs little, and memory at most doubles.
        if (bricks_.size() > merged_ + std::max(merged_, MIN_MERGED)) merge();
    }

    /// Call once all cubes have been added. Returns the bricks whose range differs from `rest`, in ascending order.
    std::vector<Brick> bricks()
    {
        merge();
        std::vector<Brick> found;
        for (Brick brick : bricks_) {
            if (brick.voxels < voxels_around(brick.number)) brick.range.include(rest_);
            if (brick.range.lower != rest_.lower || brick.range.upper != rest_.upper) found.push_back(brick);
        }
        return found;
    }
    const ImportRange<T>& rest() const { return rest_; }
    const Size3& counts() const { return counts_; }

    void save(StateWriter& state) const { state.put_all(bricks_); }
    void load(StateReader& state)
    {
        bricks_ = state.take_list<Brick>();
        merged_ = 0;
    }

private:
    static constexpr size_t MIN_MERGED = 4096;

    void merge()
    {
        std::ranges::sort(bricks_, {}, &Brick::number);
        size_t count = 0;
        for (const Brick& brick : bricks_) {
            if (count > 0 && bricks_[count - 1].number == brick.number) {
                bricks_[count - 1].voxels += brick.voxels;
                bricks_[count - 1].range.include(brick.range);
            } else {
                bricks_[count++] = brick;
            }
        }
        bricks_.resize(count);
        merged_ = count;
    }

    int64_t voxels_around(uint64_t number) const
    {
        const Size3 origin = position_of(int64_t(number), counts_) * BRICK_SIDE;
        const Size3 lower = glm::max(origin - int64_t{1}, Size3(0));
        const Size3 extent = glm::min(origin + BRICK_SIDE + int64_t{1}, size_) - lower;
        return extent.x * extent.y * extent.z;
    }

    Size3 size_, counts_;
    ImportRange<T> rest_;
    std::mutex mutex_;
    std::vector<Brick> bricks_;
    size_t merged_ = 0;
};

}  // namespace shvr

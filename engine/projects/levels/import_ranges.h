#pragma once
// Finds the ranges of the bricks of a level while its chunks are processed.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <vector>

#include "engine/projects/levels/import_cube.h"
#include "shaders/bricks.h"

namespace shvr {

/// The smallest and the largest finite value; `lower > upper` if there is none.
template <class T>
struct ImportRange {
    T lower = std::numeric_limits<T>::max();
    T upper = std::numeric_limits<T>::lowest();

    void include(const ImportRange& other)
    {
        lower = std::min(lower, other.lower);
        upper = std::max(upper, other.upper);
    }
};

/// Returns the range of one voxel: empty if the voxel is not finite.
template <class T>
ImportRange<T> range_of_voxel(const FillVoxel& voxel)
{
    T value{};
    std::memcpy(&value, voxel.data(), sizeof(T));
    return std::isfinite(double(value)) ? ImportRange<T>{value, value} : ImportRange<T>{};
}

/// The intersection of a cube with a brick and the voxels next to the brick.
template <class T>
struct BrickPart {
    int64_t brick;  ///< the brick's number, x fastest
    int64_t voxels;
    ImportRange<T> range;
};

namespace ranges {

/// A cube's part along one axis, `begin` to `end`, that lies in a brick or next to it; in voxels of the cube.
struct Segment {
    int64_t brick, begin, end;
};

inline std::vector<Segment> segments(int64_t origin, int64_t extent, int64_t bricks)
{
    constexpr int64_t BRICK = gpu::BRICK_SIZE;
    std::vector<Segment> found;
    const int64_t first = std::max<int64_t>(0, (origin - 1) / BRICK);
    for (int64_t brick = first; brick < bricks; ++brick) {
        const int64_t begin = std::max(brick * BRICK - 1, origin) - origin;
        const int64_t end = std::min((brick + 1) * BRICK + 1, origin + extent) - origin;
        if (begin >= extent) break;
        if (begin < end) found.push_back({brick, begin, end});
    }
    return found;
}

template <class T>
void add_columns(const ImportCube<T>& cube, const Segment& y, const Segment& z, const std::vector<Segment>& along_x,
                 const Size3& counts, std::vector<BrickPart<T>>& found)
{
    alignas(64) T least[IMPORT_CHUNK];
    alignas(64) T most[IMPORT_CHUNK];
    std::fill_n(least, IMPORT_CHUNK, ImportRange<T>{}.lower);
    std::fill_n(most, IMPORT_CHUNK, ImportRange<T>{}.upper);
    for (int64_t slice = z.begin; slice < z.end; ++slice) {
        for (int64_t line = y.begin; line < y.end; ++line) {
            const T* const low = cube.lowest() + cube.row(line, slice);
            const T* const high = cube.highest() + cube.row(line, slice);
            for (int64_t i = 0; i < IMPORT_CHUNK; ++i) least[i] = low[i] < least[i] ? low[i] : least[i];
            for (int64_t i = 0; i < IMPORT_CHUNK; ++i) most[i] = high[i] > most[i] ? high[i] : most[i];
        }
    }
    for (const Segment& x : along_x) {
        found.push_back({.brick = x.brick + counts.x * (y.brick + counts.y * z.brick),
                         .voxels = (x.end - x.begin) * (y.end - y.begin) * (z.end - z.begin),
                         .range = {*std::min_element(least + x.begin, least + x.end),
                                   *std::max_element(most + x.begin, most + x.end)}});
    }
}

}  // namespace ranges

/// Returns the parts of all bricks that meet a cube. `bricks`: number of bricks of the cube's level along each axis.
template <class T>
std::vector<BrickPart<T>> brick_parts(const ImportCube<T>& cube, const Size3& origin, const Size3& bricks)
{
    const std::vector<ranges::Segment> along_x = ranges::segments(origin.x, cube.extent.x, bricks.x);
    const std::vector<ranges::Segment> along_y = ranges::segments(origin.y, cube.extent.y, bricks.y);
    const std::vector<ranges::Segment> along_z = ranges::segments(origin.z, cube.extent.z, bricks.z);
    std::vector<BrickPart<T>> found;
    for (const ranges::Segment& z : along_z) {
        for (const ranges::Segment& y : along_y) ranges::add_columns(cube, y, z, along_x, bricks, found);
    }
    return found;
}

/// The ranges of all bricks of a level. Different cubes may be added at the same time.
template <class T>
class ImportRanges {
public:
    explicit ImportRanges(const Size3& size)
        : counts_(size_of_level(size, 5)), ranges_(size_t(counts_.x * counts_.y * counts_.z))
    {
        static_assert(gpu::BRICK_SIZE == 32);
    }

    void add(const ImportCube<T>& cube, const Size3& origin)
    {
        const std::vector<BrickPart<T>> parts = brick_parts(cube, origin, counts_);
        const std::lock_guard lock(mutex_);
        for (const BrickPart<T>& part : parts) ranges_[size_t(part.brick)].include(part.range);
    }

    const std::vector<ImportRange<T>>& ranges() const { return ranges_; }
    std::vector<ImportRange<T>>& ranges() { return ranges_; }

private:
    Size3 counts_;
    std::mutex mutex_;
    std::vector<ImportRange<T>> ranges_;
};

}  // namespace shvr

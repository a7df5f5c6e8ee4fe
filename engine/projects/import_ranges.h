#pragma once
// The ranges of the bricks of a level, found while its chunks stream through. For import_pyramid.cpp.

#include <algorithm>
#include <limits>
#include <mutex>
#include <vector>

#include "engine/projects/import_cube.h"
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

/// The ranges of all bricks of a level. Different cubes may be added at once.
template <class T>
class ImportRanges {
public:
    explicit ImportRanges(const Size3& size)
        : counts_(size_of_level(size, 5)), ranges_(size_t(counts_.x * counts_.y * counts_.z))
    {
        static_assert(BRICK == 32);
    }

    void add(const ImportCube<T>& cube, const Size3& origin)
    {
        const std::vector<Segment> along_x = segments(origin.x, cube.extent.x, counts_.x);
        const std::vector<Segment> along_y = segments(origin.y, cube.extent.y, counts_.y);
        const std::vector<Segment> along_z = segments(origin.z, cube.extent.z, counts_.z);
        std::vector<ImportRange<T>> found;
        for (const Segment& z : along_z) {
            for (const Segment& y : along_y) add_columns(cube, y, z, along_x, found);
        }
        const std::lock_guard lock(mutex_);
        auto range = found.begin();
        for (const Segment& z : along_z) {
            for (const Segment& y : along_y) {
                for (const Segment& x : along_x) {
                    ranges_[size_t(x.brick + counts_.x * (y.brick + counts_.y * z.brick))].include(*range++);
                }
            }
        }
    }

    const std::vector<ImportRange<T>>& ranges() const { return ranges_; }
    std::vector<ImportRange<T>>& ranges() { return ranges_; }

private:
    static constexpr int64_t BRICK = gpu::BRICK_SIZE;

    /// The part of a cube, along one axis, inside a brick and the voxel around it.
    struct Segment {
        int64_t brick, begin, end;
    };

    static std::vector<Segment> segments(int64_t origin, int64_t extent, int64_t bricks)
    {
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

    static void add_columns(const ImportCube<T>& cube, const Segment& y, const Segment& z,
                            const std::vector<Segment>& along_x, std::vector<ImportRange<T>>& found)
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
            found.push_back(
                {*std::min_element(least + x.begin, least + x.end), *std::max_element(most + x.begin, most + x.end)});
        }
    }

    Size3 counts_;
    std::mutex mutex_;
    std::vector<ImportRange<T>> ranges_;
};

}  // namespace shvr

#include "engine/volume/import_pyramid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <type_traits>

#include "engine/volume/source.h"
#include "engine/volume/voxel_dispatch.h"
#include "shaders/bricks.h"

namespace shvr {
namespace {

constexpr int64_t SIDE = IMPORT_CHUNK;
constexpr int64_t BRICK = gpu::BRICK_SIZE;
/// A chunk decides this many levels above its own.
constexpr int REACH = 6;
static_assert(SIDE == int64_t{1} << REACH);

/// Sums of eight voxels, without overflow.
template <class T>
using Sum =
    std::conditional_t<std::is_floating_point_v<T>, double, std::conditional_t<sizeof(T) == 4, int64_t, int32_t>>;

// ---- A chunk and the levels above it --------------------------------------------------------------------------------

/// Voxels of one level below a chunk, and the range of level 0 below each. Rows are SIDE voxels long whatever the extent,
/// so that loops over them have a length that compilers know; `side` rows make a slice.
template <class T>
struct Cube {
    explicit Cube(int64_t rows) : side(rows), values(static_cast<size_t>(rows * rows * SIDE)) {}

    size_t row(int64_t y, int64_t z) const { return static_cast<size_t>((y + side * z) * SIDE); }
    const T* lowest() const { return has_ranges ? lower.data() : values.data(); }
    const T* highest() const { return has_ranges ? upper.data() : values.data(); }

    int64_t side;
    Size3 extent{0};
    bool has_ranges = false;  ///< otherwise a voxel is its own range
    bool is_finite = true;    ///< every value is
    std::vector<T> values, lower, upper;
};

template <class T>
bool is_number(T value)
{
    if constexpr (std::is_floating_point_v<T>) return std::isfinite(value);
    return true;
}

/// Voxels that are no numbers have an empty range.
template <class T>
void find_own_ranges(Cube<T>& cube)
{
    if constexpr (std::is_floating_point_v<T>) {
        cube.is_finite = std::ranges::all_of(cube.values, [](T value) { return std::isfinite(value); });
        if (cube.is_finite) return;
        cube.lower = cube.values;
        cube.upper = cube.values;
        for (size_t i = 0; i < cube.values.size(); ++i) {
            if (std::isfinite(cube.values[i])) continue;
            cube.lower[i] = std::numeric_limits<T>::max();
            cube.upper[i] = std::numeric_limits<T>::lowest();
        }
        cube.has_ranges = true;
    }
}

/// The mean of `count` (1, 2, 4 or 8) integers.
template <class T>
T mean_of(Sum<T> sum, int count)
{
    if constexpr (std::is_floating_point_v<T>) {
        return static_cast<T>(sum / count);
    } else {
        const int shift = count == 8 ? 3 : count == 4 ? 2 : count == 2 ? 1 : 0;
        if (shift == 0) return static_cast<T>(sum);
        // Half of the divisor less one, and one more where that makes an even number of a tie.
        const Sum<T> odd = (sum >> shift) & 1;
        return static_cast<T>((sum + (Sum<T>{1} << (shift - 1)) - 1 + odd) >> shift);
    }
}

/// The rows of the finer cube that a row of the coarser one stands for.
struct Rows {
    std::array<size_t, 4> first{};
    int count = 0;
};

template <class T>
Rows rows_below(const Cube<T>& fine, int64_t y, int64_t z)
{
    Rows rows;
    for (int64_t dz = 2 * z; dz < std::min(2 * z + 2, fine.extent.z); ++dz) {
        for (int64_t dy = 2 * y; dy < std::min(2 * y + 2, fine.extent.y); ++dy) {
            rows.first[static_cast<size_t>(rows.count++)] = fine.row(dy, dz);
        }
    }
    return rows;
}

template <class T>
void reduce_ranges(const Cube<T>& fine, const Rows& rows, int64_t length, T* lower, T* upper)
{
    alignas(64) T least[SIDE];
    alignas(64) T most[SIDE];
    std::copy_n(fine.lowest() + rows.first[0], SIDE, least);
    std::copy_n(fine.highest() + rows.first[0], SIDE, most);
    for (int row = 1; row < rows.count; ++row) {
        const T* const low = fine.lowest() + rows.first[static_cast<size_t>(row)];
        const T* const high = fine.highest() + rows.first[static_cast<size_t>(row)];
        for (int64_t x = 0; x < SIDE; ++x) least[x] = low[x] < least[x] ? low[x] : least[x];
        for (int64_t x = 0; x < SIDE; ++x) most[x] = high[x] > most[x] ? high[x] : most[x];
    }
    for (int64_t x = 0; x < (length + 1) / 2; ++x) {
        const int64_t second = std::min(2 * x + 1, length - 1);
        lower[x] = std::min(least[2 * x], least[second]);
        upper[x] = std::max(most[2 * x], most[second]);
    }
}

template <class T>
void reduce_values(const Cube<T>& fine, const Rows& rows, int64_t length, T* values)
{
    alignas(64) Sum<T> sum[SIDE];
    const T* const first = fine.values.data() + rows.first[0];
    for (int64_t x = 0; x < SIDE; ++x) sum[x] = static_cast<Sum<T>>(first[x]);
    for (int row = 1; row < rows.count; ++row) {
        const T* const next = fine.values.data() + rows.first[static_cast<size_t>(row)];
        for (int64_t x = 0; x < SIDE; ++x) sum[x] += static_cast<Sum<T>>(next[x]);
    }
    const int64_t pairs = length / 2;
    for (int64_t x = 0; x < pairs; ++x) values[x] = mean_of<T>(sum[2 * x] + sum[2 * x + 1], 2 * rows.count);
    if (length % 2 != 0) values[pairs] = mean_of<T>(sum[length - 1], rows.count);
}

/// The same of what is finite; NaN where nothing is. Sums are taken in the same order.
template <class T>
void reduce_finite_values(const Cube<T>& fine, const Rows& rows, int64_t length, T* values)
{
    for (int64_t x = 0; x < (length + 1) / 2; ++x) {
        double sum[2] = {};
        int count = 0;
        for (int row = 0; row < rows.count; ++row) {
            const T* const voxels = fine.values.data() + rows.first[static_cast<size_t>(row)];
            for (int64_t i = 2 * x; i < std::min(2 * x + 2, length); ++i) {
                if (!is_number(voxels[i])) continue;
                sum[i - 2 * x] += static_cast<double>(voxels[i]);
                ++count;
            }
        }
        values[x] = count > 0 ? static_cast<T>((sum[0] + sum[1]) / count) : std::numeric_limits<T>::quiet_NaN();
    }
}

template <class T>
void reduce(const Cube<T>& fine, Cube<T>& coarse)
{
    coarse.extent = size_of_level(fine.extent, 1);
    coarse.has_ranges = true;
    coarse.is_finite = fine.is_finite;
    coarse.lower.resize(coarse.values.size());
    coarse.upper.resize(coarse.values.size());
    for (int64_t z = 0; z < coarse.extent.z; ++z) {
        for (int64_t y = 0; y < coarse.extent.y; ++y) {
            const Rows rows = rows_below(fine, y, z);
            const size_t to = coarse.row(y, z);
            reduce_ranges(fine, rows, fine.extent.x, coarse.lower.data() + to, coarse.upper.data() + to);
            if (std::is_floating_point_v<T> && !fine.is_finite) {
                reduce_finite_values(fine, rows, fine.extent.x, coarse.values.data() + to);
            } else {
                reduce_values(fine, rows, fine.extent.x, coarse.values.data() + to);
            }
        }
    }
}

// ---- Ranges of bricks -----------------------------------------------------------------------------------------------

template <class T>
struct Range {
    T lower = std::numeric_limits<T>::max();
    T upper = std::numeric_limits<T>::lowest();

    void include(const Range& other)
    {
        lower = std::min(lower, other.lower);
        upper = std::max(upper, other.upper);
    }
};

/// The part of a cube, along one axis, that belongs to a brick and the voxel around it.
struct Segment {
    int64_t brick, begin, end;
};

std::vector<Segment> segments(int64_t origin, int64_t extent, int64_t bricks)
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

template <class T>
class RangeTable {
public:
    explicit RangeTable(const Size3& size)
        : counts_(size_of_level(size, 5)), ranges_(static_cast<size_t>(counts_.x * counts_.y * counts_.z))
    {
        static_assert(BRICK == 32);
    }

    void add(const Cube<T>& cube, const Size3& origin)
    {
        const std::vector<Segment> along_x = segments(origin.x, cube.extent.x, counts_.x);
        const std::vector<Segment> along_y = segments(origin.y, cube.extent.y, counts_.y);
        const std::vector<Segment> along_z = segments(origin.z, cube.extent.z, counts_.z);
        std::vector<Range<T>> found;
        for (const Segment& z : along_z) {
            for (const Segment& y : along_y) add_columns(cube, y, z, along_x, found);
        }
        const std::lock_guard lock(mutex_);
        auto range = found.begin();
        for (const Segment& z : along_z) {
            for (const Segment& y : along_y) {
                for (const Segment& x : along_x) {
                    ranges_[static_cast<size_t>(x.brick + counts_.x * (y.brick + counts_.y * z.brick))].include(
                        *range++);
                }
            }
        }
    }

    const std::vector<Range<T>>& ranges() const { return ranges_; }
    std::vector<Range<T>>& ranges() { return ranges_; }

private:
    static void add_columns(const Cube<T>& cube, const Segment& y, const Segment& z,
                            const std::vector<Segment>& along_x, std::vector<Range<T>>& found)
    {
        alignas(64) T least[SIDE];
        alignas(64) T most[SIDE];
        std::fill_n(least, SIDE, Range<T>{}.lower);
        std::fill_n(most, SIDE, Range<T>{}.upper);
        for (int64_t slice = z.begin; slice < z.end; ++slice) {
            for (int64_t line = y.begin; line < y.end; ++line) {
                const T* const low = cube.lowest() + cube.row(line, slice);
                const T* const high = cube.highest() + cube.row(line, slice);
                for (int64_t i = 0; i < SIDE; ++i) least[i] = low[i] < least[i] ? low[i] : least[i];
                for (int64_t i = 0; i < SIDE; ++i) most[i] = high[i] > most[i] ? high[i] : most[i];
            }
        }
        for (const Segment& x : along_x) {
            found.push_back(
                {*std::min_element(least + x.begin, least + x.end), *std::max_element(most + x.begin, most + x.end)});
        }
    }

    Size3 counts_;
    std::mutex mutex_;
    std::vector<Range<T>> ranges_;
};

// ---- Levels that grow -----------------------------------------------------------------------------------------------

/// The slices of a level that are there: 64 of them, or the whole level.
template <class T>
struct Window {
    Window(const Size3& size_of_volume, int level)
        : size(size_of_level(size_of_volume, level)),
          is_whole(level >= REACH),
          keeps_ranges(level % REACH == 0),
          slices(is_whole ? size.z : std::min(size.z, SIDE)),
          values(static_cast<size_t>(size.x * size.y * slices))
    {
        if (!keeps_ranges) return;
        lower.resize(values.size());
        upper.resize(values.size());
    }

    /// Where a voxel of the level lies in the window.
    size_t at(int64_t x, int64_t y, int64_t z) const
    {
        return static_cast<size_t>(x + size.x * (y + size.y * (is_whole ? z : z % SIDE)));
    }

    Size3 size;
    bool is_whole;
    bool keeps_ranges;  ///< the six levels above are made of it
    int64_t slices;
    std::vector<T> values, lower, upper;
};

template <class T>
class Pyramid final : public ImportPyramid {
public:
    Pyramid(const Size3& size, int workers) : ImportPyramid(size)
    {
        for (int level = 0; level < levels(); ++level) {
            tables_.push_back(std::make_unique<RangeTable<T>>(size_of_level(size, level)));
            if (level > 0) windows_.emplace_back(size, level);
        }
        for (int worker = 0; worker < workers; ++worker) scratch_.emplace_back();
    }

    std::span<const std::byte> add(const Chunk& chunk, int worker) override
    {
        Cube<T>& cube = scratch_[static_cast<size_t>(worker)].cubes[0];
        cube.has_ranges = false;
        fill(cube, chunk.extent, [&](int64_t y, int64_t z, std::vector<T> Cube<T>::*of, T* row) {
            const std::byte* const from =
                chunk.voxels + static_cast<size_t>(z) * chunk.slice_bytes + static_cast<size_t>(y) * chunk.row_bytes;
            if (of == &Cube<T>::values) std::memcpy(row, from, static_cast<size_t>(chunk.extent.x) * sizeof(T));
        });
        cube.is_finite = true;
        find_own_ranges(cube);
        tables_[0]->add(cube, chunk.origin);
        cascade(0, chunk.origin, worker);
        return std::as_bytes(std::span(cube.values));
    }

    void finish() override
    {
        for (int base = REACH; base < levels(); base += REACH) {
            const Window<T>& window = window_of(base);
            Size3 origin;
            for (origin.z = 0; origin.z < window.size.z; origin.z += SIDE) {
                for (origin.y = 0; origin.y < window.size.y; origin.y += SIDE) {
                    for (origin.x = 0; origin.x < window.size.x; origin.x += SIDE) add_of_window(base, origin);
                }
            }
        }
    }

    std::span<const std::byte> gather(int level, const Size3& chunk, int worker) override
    {
        const Window<T>& window = window_of(level);
        const Size3 origin = chunk * SIDE;
        Cube<T>& cube = scratch_[static_cast<size_t>(worker)].cubes[0];
        fill(cube, glm::min(Size3(SIDE), window.size - origin),
             [&](int64_t y, int64_t z, std::vector<T> Cube<T>::*of, T* row) {
                 if (of != &Cube<T>::values) return;
                 std::copy_n(window.values.data() + window.at(origin.x, origin.y + y, origin.z + z), cube.extent.x,
                             row);
             });
        return std::as_bytes(std::span(cube.values));
    }

    void clear_layer(int level) override
    {
        Window<T>& window = windows_[static_cast<size_t>(level - 1)];
        std::fill(window.values.begin(), window.values.end(), T{});
    }

    std::vector<std::byte> ranges(int level) const override
    {
        const auto bytes = std::as_bytes(std::span(tables_[static_cast<size_t>(level)]->ranges()));
        static_assert(sizeof(Range<T>) == 2 * sizeof(T));
        return {bytes.begin(), bytes.end()};
    }

    void save(StateWriter& state) const override
    {
        for (const auto& table : tables_) state.put_all(table->ranges());
        for (const Window<T>& window : windows_) {
            state.put_all(window.values);
            state.put_all(window.lower);
            state.put_all(window.upper);
        }
    }

    void load(StateReader& state) override
    {
        for (const auto& table : tables_) state.take_all(table->ranges());
        for (Window<T>& window : windows_) {
            state.take_all(window.values);
            state.take_all(window.lower);
            state.take_all(window.upper);
        }
    }

private:
    struct Scratch {
        Scratch()
        {
            for (int level = 0; level <= REACH; ++level) cubes.emplace_back(SIDE >> level);
        }
        std::vector<Cube<T>> cubes;
    };

    const Window<T>& window_of(int level) const { return windows_[static_cast<size_t>(level - 1)]; }

    /// Every row from `put`, 0 beyond the extent.
    template <class Put>
    static void fill(Cube<T>& cube, const Size3& extent, const Put& put)
    {
        const bool is_part = extent != Size3(SIDE);
        cube.extent = extent;
        if (is_part) std::fill(cube.values.begin(), cube.values.end(), T{});
        for (int64_t z = 0; z < extent.z; ++z) {
            for (int64_t y = 0; y < extent.y; ++y) {
                put(y, z, &Cube<T>::values, cube.values.data() + cube.row(y, z));
                if (!cube.has_ranges) continue;
                put(y, z, &Cube<T>::lower, cube.lower.data() + cube.row(y, z));
                put(y, z, &Cube<T>::upper, cube.upper.data() + cube.row(y, z));
            }
        }
    }

    /// The six levels above the cube of level `base` that lies in the worker's scratch memory.
    void cascade(int base, const Size3& origin, int worker)
    {
        std::vector<Cube<T>>& cubes = scratch_[static_cast<size_t>(worker)].cubes;
        Size3 at = origin;
        for (int above = 1; above <= REACH && base + above < levels(); ++above) {
            Cube<T>& cube = cubes[static_cast<size_t>(above)];
            reduce(cubes[static_cast<size_t>(above - 1)], cube);
            at = at / int64_t{2};
            tables_[static_cast<size_t>(base + above)]->add(cube, at);
            store(cube, at, windows_[static_cast<size_t>(base + above - 1)]);
        }
    }

    /// Chunks do not overlap, so neither do the places they write to.
    static void store(const Cube<T>& cube, const Size3& origin, Window<T>& window)
    {
        for (int64_t z = 0; z < cube.extent.z; ++z) {
            for (int64_t y = 0; y < cube.extent.y; ++y) {
                const size_t to = window.at(origin.x, origin.y + y, origin.z + z);
                const size_t from = cube.row(y, z);
                const auto length = static_cast<size_t>(cube.extent.x);
                std::copy_n(cube.values.data() + from, length, window.values.data() + to);
                if (!window.keeps_ranges) continue;
                std::copy_n(cube.lower.data() + from, length, window.lower.data() + to);
                std::copy_n(cube.upper.data() + from, length, window.upper.data() + to);
            }
        }
    }

    void add_of_window(int base, const Size3& origin)
    {
        const Window<T>& window = window_of(base);
        Cube<T>& cube = scratch_[0].cubes[0];
        cube.has_ranges = true;
        cube.lower.assign(cube.values.size(), Range<T>{}.lower);
        cube.upper.assign(cube.values.size(), Range<T>{}.upper);
        fill(cube, glm::min(Size3(SIDE), window.size - origin),
             [&](int64_t y, int64_t z, std::vector<T> Cube<T>::*of, T* row) {
                 const std::vector<T>& from = of == &Cube<T>::values  ? window.values
                                              : of == &Cube<T>::lower ? window.lower
                                                                      : window.upper;
                 std::copy_n(from.data() + window.at(origin.x, origin.y + y, origin.z + z), cube.extent.x, row);
             });
        cube.is_finite = std::ranges::all_of(cube.values, is_number<T>);
        cascade(base, origin, 0);
        cube.has_ranges = false;
    }

    std::vector<std::unique_ptr<RangeTable<T>>> tables_;  ///< by level
    std::vector<Window<T>> windows_;                      ///< by level, from 1
    std::vector<Scratch> scratch_;                        ///< by worker
};

}  // namespace

int level_count(const Size3& size)
{
    int levels = 1;
    while (glm::any(glm::greaterThan(size_of_level(size, levels - 1), Size3(BRICK)))) ++levels;
    return levels;
}

bool ImportPyramid::completes_layer(int level, int64_t slices) const
{
    if (level >= REACH) return false;
    return slices >= size_.z || slices % (SIDE << level) == 0;
}

std::unique_ptr<ImportPyramid> make_import_pyramid(const Size3& size, VoxelType type, int workers)
{
    return with_voxel_type(type, [&]<class T>(T) -> std::unique_ptr<ImportPyramid> {
        return std::make_unique<Pyramid<T>>(size, workers);
    });
}

}  // namespace shvr

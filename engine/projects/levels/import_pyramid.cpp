#include "engine/projects/levels/import_pyramid.h"

#include <algorithm>

#include "engine/projects/levels/import_cube.h"
#include "engine/projects/levels/import_ranges.h"
#include "engine/volume/source.h"
#include "engine/volume/voxel_dispatch.h"
#include "shaders/bricks.h"

namespace shvr {
namespace {

constexpr int REACH = IMPORT_REACH;

/// The slices of a level that are kept in memory: 64 slices, or the whole level if it is small.
template <class T>
struct Window {
    Window(const Size3& size_of_volume, int level)
        : size(size_of_level(size_of_volume, level)),
          is_whole(level >= REACH),
          keeps_ranges(level % REACH == 0),
          slices(is_whole ? size.z : std::min(size.z, IMPORT_CHUNK)),
          values(size_t(size.x * size.y * slices))
    {
        if (!keeps_ranges) return;
        lower.resize(values.size());
        upper.resize(values.size());
    }

    /// Returns the index in `values` of a voxel of the level.
    size_t at(int64_t x, int64_t y, int64_t z) const
    {
        return size_t(x + size.x * (y + size.y * (is_whole ? z : z % IMPORT_CHUNK)));
    }

    /// Number of voxels in a slice.
    size_t slice() const { return size_t(size.x * size.y); }

    Size3 size;
    bool is_whole;
    bool keeps_ranges;  ///< whether ranges are kept, since this level is the base of the next six
    int64_t slices;
    std::vector<T> values, lower, upper;
};

template <class T>
class Pyramid final : public ImportPyramid {
public:
    Pyramid(const Size3& size, int workers, Halving how, const FillVoxel& fill_voxel) : ImportPyramid(size), how_(how)
    {
        std::memcpy(&fill_, fill_voxel.data(), sizeof(T));
        for (int level = 0; level < levels(); ++level) {
            tables_.push_back(std::make_unique<ImportRanges<T>>(size_of_level(size, level)));
            if (level > 0) windows_.emplace_back(size, level);
        }
        for (int worker = 0; worker < workers; ++worker) scratch_.emplace_back();
    }

    std::span<const std::byte> add(const Chunk& chunk, int worker) override
    {
        ImportCube<T>& cube = scratch_[size_t(worker)].cubes[0];
        cube.has_ranges = false;
        fill(cube, chunk.extent, [&](int64_t y, int64_t z, std::vector<T> ImportCube<T>::*of, T* row) {
            const std::byte* const from = chunk.voxels + size_t(z) * chunk.slice_bytes + size_t(y) * chunk.row_bytes;
            if (of == &ImportCube<T>::values) std::memcpy(row, from, size_t(chunk.extent.x) * sizeof(T));
        });
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
            for (origin.z = 0; origin.z < window.size.z; origin.z += IMPORT_CHUNK) {
                for (origin.y = 0; origin.y < window.size.y; origin.y += IMPORT_CHUNK) {
                    for (origin.x = 0; origin.x < window.size.x; origin.x += IMPORT_CHUNK) add_of_window(base, origin);
                }
            }
        }
    }

    std::span<const std::byte> gather(int level, const Size3& chunk, int worker) override
    {
        const Window<T>& window = window_of(level);
        const Size3 origin = chunk * IMPORT_CHUNK;
        ImportCube<T>& cube = scratch_[size_t(worker)].cubes[0];
        fill(cube, glm::min(Size3(IMPORT_CHUNK), window.size - origin),
             [&](int64_t y, int64_t z, std::vector<T> ImportCube<T>::*of, T* row) {
                 if (of != &ImportCube<T>::values) return;
                 std::copy_n(window.values.data() + window.at(origin.x, origin.y + y, origin.z + z), cube.extent.x,
                             row);
             });
        return std::as_bytes(std::span(cube.values));
    }

    void clear_layer(int level) override
    {
        Window<T>& window = windows_[size_t(level - 1)];
        std::fill(window.values.begin(), window.values.end(), T{});
    }

    std::vector<std::byte> slices(int level, int64_t lower, int64_t upper) const override
    {
        const Window<T>& window = window_of(level);
        std::vector<std::byte> bytes;
        for (const std::vector<T>* values : {&window.values, &window.lower, &window.upper})
            for (int64_t z = lower; z < upper && !values->empty(); ++z) {
                const auto slice = std::as_bytes(std::span(*values).subspan(window.at(0, 0, z), window.slice()));
                bytes.insert(bytes.end(), slice.begin(), slice.end());
            }
        return bytes;
    }

    bool put_slices(int level, int64_t lower, int64_t upper, std::span<const std::byte> slices) override
    {
        Window<T>& window = windows_[size_t(level - 1)];
        const size_t slice_bytes = window.slice() * sizeof(T), arrays = window.keeps_ranges ? 3 : 1;
        if (lower < 0 || upper > window.size.z || slices.size() != arrays * size_t(upper - lower) * slice_bytes)
            return false;
        for (std::vector<T>* values : {&window.values, &window.lower, &window.upper})
            for (int64_t z = lower; z < upper && !values->empty(); ++z) {
                std::memcpy(values->data() + window.at(0, 0, z), slices.data(), slice_bytes);
                slices = slices.subspan(slice_bytes);
            }
        return true;
    }

    bool include_ranges(int level, std::span<const std::byte> ranges) override
    {
        std::vector<ImportRange<T>>& known = tables_[size_t(level)]->ranges();
        if (ranges.size() != known.size() * sizeof(ImportRange<T>)) return false;
        for (ImportRange<T>& range : known) {
            ImportRange<T> other;
            std::memcpy(&other, ranges.data(), sizeof other);
            range.include(other);
            ranges = ranges.subspan(sizeof other);
        }
        return true;
    }

    std::vector<std::byte> ranges(int level) const override
    {
        const auto bytes = std::as_bytes(std::span(tables_[size_t(level)]->ranges()));
        static_assert(sizeof(ImportRange<T>) == 2 * sizeof(T));
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
            for (int level = 0; level <= REACH; ++level) cubes.emplace_back(IMPORT_CHUNK >> level);
        }
        std::vector<ImportCube<T>> cubes;
    };

    const Window<T>& window_of(int level) const { return windows_[size_t(level - 1)]; }

    /// Fills the rows inside `extent` by calling `put`, and all voxels outside with the fill value.
    template <class Put>
    void fill(ImportCube<T>& cube, const Size3& extent, const Put& put) const
    {
        const bool is_part = extent != Size3(IMPORT_CHUNK);
        cube.extent = extent;
        if (is_part) std::fill(cube.values.begin(), cube.values.end(), fill_);
        for (int64_t z = 0; z < extent.z; ++z) {
            for (int64_t y = 0; y < extent.y; ++y) {
                put(y, z, &ImportCube<T>::values, cube.values.data() + cube.row(y, z));
                if (!cube.has_ranges) continue;
                put(y, z, &ImportCube<T>::lower, cube.lower.data() + cube.row(y, z));
                put(y, z, &ImportCube<T>::upper, cube.upper.data() + cube.row(y, z));
            }
        }
    }

    /// Computes the six levels above a cube of level `base`, in the worker's scratch memory.
    void cascade(int base, const Size3& origin, int worker)
    {
        std::vector<ImportCube<T>>& cubes = scratch_[size_t(worker)].cubes;
        Size3 at = origin;
        for (int above = 1; above <= REACH && base + above < levels(); ++above) {
            ImportCube<T>& cube = cubes[size_t(above)];
            halve_cube(cubes[size_t(above - 1)], cube, how_);
            at = at / int64_t{2};
            tables_[size_t(base + above)]->add(cube, at);
            store(cube, at, windows_[size_t(base + above - 1)]);
        }
    }

    /// Needs no lock, since different chunks write to disjoint regions of the window.
    static void store(const ImportCube<T>& cube, const Size3& origin, Window<T>& window)
    {
        for (int64_t z = 0; z < cube.extent.z; ++z) {
            for (int64_t y = 0; y < cube.extent.y; ++y) {
                const size_t to = window.at(origin.x, origin.y + y, origin.z + z);
                const size_t from = cube.row(y, z);
                const auto length = size_t(cube.extent.x);
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
        ImportCube<T>& cube = scratch_[0].cubes[0];
        cube.has_ranges = true;
        cube.lower.assign(cube.values.size(), ImportRange<T>{}.lower);
        cube.upper.assign(cube.values.size(), ImportRange<T>{}.upper);
        fill(cube, glm::min(Size3(IMPORT_CHUNK), window.size - origin),
             [&](int64_t y, int64_t z, std::vector<T> ImportCube<T>::*of, T* row) {
                 const std::vector<T>& from = of == &ImportCube<T>::values  ? window.values
                                              : of == &ImportCube<T>::lower ? window.lower
                                                                            : window.upper;
                 std::copy_n(from.data() + window.at(origin.x, origin.y + y, origin.z + z), cube.extent.x, row);
             });
        cascade(base, origin, 0);
        cube.has_ranges = false;
    }

    Halving how_;
    T fill_{};
    std::vector<std::unique_ptr<ImportRanges<T>>> tables_;  ///< by level
    std::vector<Window<T>> windows_;                        ///< by level, starting at level 1
    std::vector<Scratch> scratch_;                          ///< by worker
};

}  // namespace

int level_count(const Size3& size)
{
    int levels = 1;
    while (glm::any(glm::greaterThan(size_of_level(size, levels - 1), Size3(gpu::BRICK_SIZE)))) ++levels;
    return levels;
}

bool ImportPyramid::completes_layer(int level, int64_t slices) const
{
    if (level >= REACH) return false;
    return slices >= size_.z || slices % (IMPORT_CHUNK << level) == 0;
}

std::unique_ptr<ImportPyramid> make_import_pyramid(const Size3& size, VoxelType type, int workers, Halving how,
                                                   const FillVoxel& fill)
{
    return with_voxel_type(type, [&]<class T>(T) -> std::unique_ptr<ImportPyramid> {
        return std::make_unique<Pyramid<T>>(size, workers, how, fill);
    });
}

}  // namespace shvr

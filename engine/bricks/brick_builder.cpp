#include "engine/bricks/brick_builder.h"

#include <algorithm>
#include <condition_variable>
#include <cstring>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/waits/waits.h"
#include "engine/bricks/code_rows.h"

namespace shvr {
namespace {

constexpr int64_t SIZE = gpu::BRICK_SIZE;
constexpr int64_t APRON = gpu::BRICK_APRON;
constexpr int64_t TEXELS = gpu::BRICK_TEXELS;
constexpr size_t CELLS = gpu::BRICK_CELLS;
constexpr size_t CELL_STEP = gpu::CELL_SIZE;
constexpr size_t CELL_REACH = gpu::CELL_SIZE + 2;  ///< texels along each axis that samples in a cell can read
/// Number of bricks along x that a worker builds in one task: 5 MiB of texels.
constexpr int64_t ROW_BRICKS = 64;
/// Number of slices that a worker reads in one task.
constexpr int64_t READ_SLICES = 4;

// ---- Cell ranges ----------------------------------------------------------------------------------------------------

/// Eight codes in one register, which every x86-64 and ARM64 processor has (GCC's and Clang's vector extension).
using Lanes [[gnu::vector_size(16)]] = uint16_t;
constexpr size_t LANES = 8;
constexpr size_t ROW_PITCH = 40;  ///< TEXELS rounded up to LANES

Lanes load(const uint16_t* codes)
{
    Lanes lanes;
    std::memcpy(&lanes, codes, sizeof(lanes));
    return lanes;
}

/// Computes each column's minimum and maximum code over CELL_REACH rows (`pitch` apart). LANES divides `length`.
void reduce_rows(const uint16_t* low, const uint16_t* high, size_t pitch, size_t length, uint16_t* minimum,
                 uint16_t* maximum)
{
    for (size_t at = 0; at < length; at += LANES) {
        Lanes least = load(low + at);
        Lanes most = load(high + at);
        for (size_t row = 1; row < CELL_REACH; ++row) {
            const Lanes next_low = load(low + row * pitch + at);
            const Lanes next_high = load(high + row * pitch + at);
            least = next_low < least ? next_low : least;
            most = next_high > most ? next_high : most;
        }
        std::memcpy(minimum + at, &least, sizeof(least));
        std::memcpy(maximum + at, &most, sizeof(most));
    }
}

/// Reduces one axis after another (z, then y, then x), so that the long loops read contiguous memory.
void find_ranges(BrickTexels& brick)
{
    constexpr size_t SLICE = size_t(TEXELS * TEXELS);
    constexpr size_t SLICE_PITCH = (SLICE + LANES - 1) / LANES * LANES;
    alignas(64) uint16_t minimum_z[CELLS][SLICE_PITCH + LANES];
    alignas(64) uint16_t maximum_z[CELLS][SLICE_PITCH + LANES];
    for (size_t z = 0; z < CELLS; ++z) {
        const uint16_t* const first = brick.codes.data() + z * CELL_STEP * SLICE;
        constexpr size_t EVEN = SLICE / LANES * LANES;
        reduce_rows(first, first, SLICE, EVEN, minimum_z[z], maximum_z[z]);
        // The last LANES texels of the slice overlap texels that were already processed.
        const size_t last = SLICE - LANES;
        reduce_rows(first + last, first + last, SLICE, LANES, minimum_z[z] + last, maximum_z[z] + last);
        std::fill(minimum_z[z] + SLICE, minimum_z[z] + SLICE_PITCH + LANES, uint16_t{0});
        std::fill(maximum_z[z] + SLICE, maximum_z[z] + SLICE_PITCH + LANES, uint16_t{0});
    }

    brick.range = {65535, 0};
    BrickTexels::Range* cell = brick.cell_ranges.data();
    for (size_t z = 0; z < CELLS; ++z) {
        for (size_t y = 0; y < CELLS; ++y) {
            alignas(64) uint16_t minimum_y[ROW_PITCH];
            alignas(64) uint16_t maximum_y[ROW_PITCH];
            // Reads ROW_PITCH texels, more than the row's TEXELS; the loop over x ignores the excess.
            const size_t first = y * CELL_STEP * size_t(TEXELS);
            reduce_rows(minimum_z[z] + first, maximum_z[z] + first, TEXELS, ROW_PITCH, minimum_y, maximum_y);
            for (size_t x = 0; x < CELLS; ++x, ++cell) {
                const uint16_t* const low = minimum_y + x * CELL_STEP;
                const uint16_t* const high = maximum_y + x * CELL_STEP;
                *cell = {*std::min_element(low, low + CELL_REACH), *std::max_element(high, high + CELL_REACH)};
                brick.range.minimum = std::min(brick.range.minimum, cell->minimum);
                brick.range.maximum = std::max(brick.range.maximum, cell->maximum);
            }
        }
    }
}

// ---- Slabs, and bricks made of them ---------------------------------------------------------------------------------

/// The voxels of one layer of bricks, aprons included, in the source's format.
using Slab = std::vector<std::byte>;

/// A run of bricks along x.
struct BrickRow {
    glm::ivec3 first{0};
    int count = 0;
    std::vector<BrickTexels> bricks;
};

class Builder {
public:
    Builder(const VolumeSource& source, const IntensityWindow& window)
        : source_(source),
          size_(source.info().size),
          voxel_bytes_(int64_t(bytes_of(source.info().type))),
          code_rows_(source.info().type, window)
    {}

    int64_t first_slice(int64_t layer) const { return std::max<int64_t>(0, layer * SIZE - APRON); }
    int64_t end_slice(int64_t layer) const { return std::min(size_.z, (layer + 1) * SIZE + APRON); }
    int64_t slice_bytes() const { return size_.x * size_.y * voxel_bytes_; }

    void read(Slab& slab, int64_t layer, int64_t lower, int64_t upper) const
    {
        const auto offset = size_t((lower - first_slice(layer)) * slice_bytes());
        source_.read({{0, 0, lower}, {size_.x, size_.y, upper}},
                     std::span(slab).subspan(offset, size_t((upper - lower) * slice_bytes())));
    }

    void build(const Slab& slab, BrickRow& row) const
    {
        if (row.bricks.size() < size_t(row.count)) row.bricks.resize(size_t(row.count));
        const int64_t begin = row.first.x * SIZE - APRON;
        const int64_t first_x = std::max<int64_t>(0, begin);
        const int64_t end_x = std::min(size_.x, (row.first.x + row.count) * SIZE + APRON);
        std::vector<uint16_t> codes(size_t(row.count * SIZE + 2 * APRON));
        const std::span<uint16_t> inside(codes.data() + (first_x - begin), size_t(end_x - first_x));
        const size_t inside_bytes = inside.size() * size_t(voxel_bytes_);
        for (int64_t z = 0; z < TEXELS; ++z) {
            const int64_t slice =
                std::clamp<int64_t>(row.first.z * SIZE + z - APRON, 0, size_.z - 1) - first_slice(row.first.z);
            for (int64_t y = 0; y < TEXELS; ++y) {
                const int64_t line = std::clamp<int64_t>(row.first.y * SIZE + y - APRON, 0, size_.y - 1);
                const int64_t offset = (first_x + size_.x * (line + size_.y * slice)) * voxel_bytes_;
                code_rows_.convert(std::span(slab).subspan(size_t(offset), inside_bytes), inside);
                std::fill(codes.data(), inside.data(), inside.front());
                std::fill(inside.data() + inside.size(), codes.data() + codes.size(), inside.back());
                for (int64_t brick = 0; brick < row.count; ++brick) {
                    std::memcpy(row.bricks[size_t(brick)].codes.data() + TEXELS * (y + TEXELS * z),
                                codes.data() + brick * SIZE, TEXELS * sizeof(uint16_t));
                }
            }
        }
        for (int brick = 0; brick < row.count; ++brick) find_ranges(row.bricks[size_t(brick)]);
    }

private:
    const VolumeSource& source_;
    Size3 size_;
    int64_t voxel_bytes_;
    CodeRows code_rows_;
};

// ---- Scheduling -----------------------------------------------------------------------------------------------------

/// The tasks in the order in which workers start them: for each layer of bricks, first its reads, then its rows. No
/// task waits for a later task, so workers that start tasks in this order never deadlock.
///
/// Keeps two slabs: one is read while rows are built from the other. A read waits until all rows of its slab's previous
/// layer are built. A row waits for the reads of its slab, and until `take` has freed a place in `rows_`.
class Pipeline {
public:
    Pipeline(const VolumeSource& source, const IntensityWindow& window, int threads)
        : builder_(source, window), counts_(brick_counts(source.info().size)), rows_(size_t(threads) + 2)
    {
        runs_per_line_ = (counts_.x + ROW_BRICKS - 1) / ROW_BRICKS;
        rows_per_layer_ = runs_per_line_ * counts_.y;
        reads_done_.resize(size_t(counts_.z));
        rows_done_.resize(size_t(counts_.z));
        row_is_built_.resize(rows_.size());
        const int64_t slices = std::min(source.info().size.z, TEXELS);
        for (int layer = 0; layer < std::min(2, counts_.z); ++layer) {
            slabs_[size_t(layer)].resize(size_t(slices * builder_.slice_bytes()));
        }
    }

    int64_t row_count() const { return rows_per_layer_ * counts_.z; }

    /// A worker's loop: runs tasks until none is left.
    void work()
    {
        try {
            while (do_next()) {
            }
        } catch (...) {
            stop(std::current_exception());
        }
    }

    /// Waits for the next row in order and returns it. Rethrows an exception of a worker.
    const BrickRow& wait_for_row()
    {
        std::unique_lock lock(mutex_);
        const size_t place = place_of(rows_taken_);
        changed_.wait(lock, [&] { return row_is_built_[place] || is_stopped_; });
        if (failure_) std::rethrow_exception(failure_);
        return rows_[place];
    }
    void give_back_row()
    {
        const std::lock_guard lock(mutex_);
        row_is_built_[place_of(rows_taken_)] = false;
        ++rows_taken_;
        changed_.notify_all();
    }

    void stop(std::exception_ptr failure)
    {
        const std::lock_guard lock(mutex_);
        if (!failure_) failure_ = std::move(failure);
        is_stopped_ = true;
        changed_.notify_all();
    }

private:
    size_t place_of(int64_t row) const { return size_t(row) % rows_.size(); }
    /// Two slices of a layer also belong to the previous layer; they are read once and copied.
    int64_t first_new_slice(int64_t layer) const { return layer == 0 ? 0 : builder_.end_slice(layer - 1); }
    int64_t read_count(int64_t layer) const
    {
        const int64_t slices = builder_.end_slice(layer) - first_new_slice(layer);
        return std::max<int64_t>(1, (slices + READ_SLICES - 1) / READ_SLICES);
    }

    bool do_next()
    {
        std::unique_lock lock(mutex_);
        if (is_stopped_ || layer_ == counts_.z) return false;
        const int64_t layer = layer_;
        const int64_t task = task_++;
        const int64_t reads = read_count(layer);
        if (task_ == reads + rows_per_layer_) {
            ++layer_;
            task_ = 0;
        }
        return task < reads ? do_read(lock, layer, task) : do_row(lock, layer, task - reads);
    }

    bool do_read(std::unique_lock<std::mutex>& lock, int64_t layer, int64_t read)
    {
        // Slices shared with the previous layer are copied from it; it must be complete and must not change meanwhile.
        changed_.wait(lock, [&] {
            const bool slab_is_free = layer < 2 || rows_done_[size_t(layer - 2)] == rows_per_layer_;
            const bool before_is_read = layer == 0 || reads_done_[size_t(layer - 1)] == read_count(layer - 1);
            return is_stopped_ || (slab_is_free && before_is_read);
        });
        if (is_stopped_) return false;
        lock.unlock();
        if (read == 0 && layer > 0) copy_shared_slices(layer);
        const int64_t lower = first_new_slice(layer) + read * READ_SLICES;
        const int64_t upper = std::min(builder_.end_slice(layer), lower + READ_SLICES);
        if (lower < upper) builder_.read(slabs_[size_t(layer % 2)], layer, lower, upper);
        lock.lock();
        ++reads_done_[size_t(layer)];
        changed_.notify_all();
        return true;
    }

    void copy_shared_slices(int64_t layer)
    {
        const Slab& before = slabs_[size_t((layer - 1) % 2)];
        Slab& slab = slabs_[size_t(layer % 2)];
        const int64_t first = builder_.first_slice(layer);
        const auto offset = size_t((first - builder_.first_slice(layer - 1)) * builder_.slice_bytes());
        const auto bytes = size_t((first_new_slice(layer) - first) * builder_.slice_bytes());
        std::memcpy(slab.data(), before.data() + offset, bytes);
    }

    bool do_row(std::unique_lock<std::mutex>& lock, int64_t layer, int64_t row)
    {
        const int64_t number = layer * rows_per_layer_ + row;
        changed_.wait(lock, [&] {
            const bool slab_is_read = reads_done_[size_t(layer)] == read_count(layer);
            return is_stopped_ || (slab_is_read && number < rows_taken_ + int64_t(rows_.size()));
        });
        if (is_stopped_) return false;
        lock.unlock();
        BrickRow& bricks = rows_[place_of(number)];
        const int64_t run = row % runs_per_line_;
        bricks.first = {int(run * ROW_BRICKS), int(row / runs_per_line_), int(layer)};
        bricks.count = int(std::min(ROW_BRICKS, counts_.x - run * ROW_BRICKS));
        builder_.build(slabs_[size_t(layer % 2)], bricks);
        lock.lock();
        row_is_built_[place_of(number)] = true;
        ++rows_done_[size_t(layer)];
        changed_.notify_all();
        return true;
    }

    Builder builder_;
    glm::ivec3 counts_;
    int64_t runs_per_line_ = 0;
    int64_t rows_per_layer_ = 0;
    std::array<Slab, 2> slabs_;

    std::mutex mutex_;
    std::condition_variable changed_;
    int64_t layer_ = 0;  ///< layer of the next task (a read or a row) to hand out
    int64_t task_ = 0;
    int64_t rows_taken_ = 0;
    std::vector<int64_t> reads_done_, rows_done_;  ///< by layer
    std::vector<bool> row_is_built_;               ///< by place in `rows_`
    std::vector<BrickRow> rows_;                   ///< ring buffer: row i is at index i modulo the buffer's size
    bool is_stopped_ = false;
    std::exception_ptr failure_;
};

}  // namespace

glm::ivec3 brick_counts(const Size3& size)
{
    return glm::ivec3((size + (SIZE - 1)) / SIZE);
}

VoxelBox voxels_of_texels(const BrickKey& key, const Size3& volume)
{
    const Size3 begin = SIZE * Size3(key.brick) - APRON;
    return {glm::max(begin, Size3(0)), glm::min(begin + TEXELS, size_of_level(volume, key.level))};
}

void BrickMaker::make(const BrickKey& key, BrickTexels& texels)
{
    const Size3 begin = SIZE * Size3(key.brick) - APRON;
    const VoxelBox box = voxels_of_texels(key, source_.info().size);
    const Size3 extent = box.size();
    const auto row_bytes = size_t(extent.x) * bytes_of(source_.info().type);
    voxels_.resize(row_bytes * size_t(extent.y * extent.z));
    source_.read_level(key.level, box, voxels_);

    const int64_t inside_begin = box.lower.x - begin.x;
    for (int64_t z = 0; z < TEXELS; ++z) {
        const int64_t slice = std::clamp<int64_t>(begin.z + z, box.lower.z, box.upper.z - 1) - box.lower.z;
        for (int64_t y = 0; y < TEXELS; ++y) {
            const int64_t line = std::clamp<int64_t>(begin.y + y, box.lower.y, box.upper.y - 1) - box.lower.y;
            const std::span<uint16_t> row(texels.codes.data() + TEXELS * (y + TEXELS * z), TEXELS);
            const auto inside = row.subspan(size_t(inside_begin), size_t(extent.x));
            code_rows_.convert(std::span(voxels_).subspan(row_bytes * size_t(line + extent.y * slice), row_bytes),
                               inside);
            std::fill(row.begin(), inside.begin(), inside.front());
            std::fill(inside.end(), row.end(), inside.back());
        }
    }
    find_ranges(texels);
}

void build_bricks(const VolumeSource& source, const IntensityWindow& window, int threads,
                  const std::function<void(const glm::ivec3& brick, const BrickTexels& texels)>& take)
{
    static_cast<void>(voxel_count(source.info()));
    Pipeline pipeline(source, window, std::max(1, threads));
    const std::function<bool()> waits_are_over = waits_of_this_thread();
    std::vector<std::jthread> workers;
    try {
        for (int i = 0; i < std::max(1, threads); ++i)
            workers.emplace_back([&] {
                const WaitsUntil waits(waits_are_over);
                pipeline.work();
            });
        for (int64_t row = 0; row < pipeline.row_count(); ++row) {
            const BrickRow& built = pipeline.wait_for_row();
            for (int i = 0; i < built.count; ++i) take(built.first + glm::ivec3(i, 0, 0), built.bricks[size_t(i)]);
            pipeline.give_back_row();
        }
    } catch (...) {
        pipeline.stop(std::current_exception());
        throw;
    }
}

}  // namespace shvr

#include "engine/components/components.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>
#include <thread>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/work_pool.h"
#include "engine/components/bit_slab.h"
#include "engine/components/component_runs.h"
#include "engine/components/label_forest.h"
#include "engine/volume/voxel_dispatch.h"

namespace shvr {
namespace {

constexpr uint32_t NO_LABEL = std::numeric_limits<uint32_t>::max();
/// Ranges per thread (several, to balance the load, as some ranges hold more runs), and a range's minimum thickness.
constexpr int64_t RANGES_PER_THREAD = 4, THINNEST_RANGE = 16;
/// Maximum size of a slice stored as bits: 2^33 voxels.
constexpr int64_t MAX_SLICE_BYTES = int64_t{1} << 30;

[[noreturn]] void refuse_labels()
{
    fail("the voxels at or above the threshold have more than 4294967295 provisional labels; expected fewer: a higher ",
         "threshold, or a part of the volume");
}

/// Memory in use, and its maximum.
class HeldBytes {
public:
    void change(int64_t bytes)
    {
        const int64_t now = now_.fetch_add(bytes) + bytes;
        int64_t peak = peak_.load();
        while (now > peak && !peak_.compare_exchange_weak(peak, now)) continue;
    }
    int64_t peak() const { return peak_; }

private:
    std::atomic<int64_t> now_ = 0, peak_ = 0;
};

/// Joins touching runs of two neighbouring rows; with `reach` 1, runs may also touch at an edge or a corner. A run of
/// `row` without a label takes the label of the run it touches.
void join_rows(std::span<LabelledRun> row, std::span<const LabelledRun> before, uint32_t reach, LabelForest& forest)
{
    auto first = before.begin();
    for (LabelledRun& run : row) {
        while (first != before.end() && first->end + reach <= run.begin) ++first;
        for (auto other = first; other != before.end() && other->begin < run.end + reach; ++other) {
            if (run.label == NO_LABEL)
                run.label = other->label;
            else if (run.label != other->label)
                run.label = forest.join(run.label, other->label);
        }
    }
}

/// Joins a row with the row at the same y in the preceding slice and, for connectivity over corners, with the rows next
/// to that one. `at` is a position in `before` that each call advances: callers set it to 0 for a slice's first row.
void join_slices(std::span<LabelledRun> row, int64_t y, SliceRuns& before, size_t& at, Connectivity connectivity,
                 LabelForest& forest)
{
    const uint32_t reach = connectivity == Connectivity::faces ? 0 : 1;
    while (at < before.rows.size() && int64_t{before.rows[at].y} + reach < y) ++at;
    for (size_t near = at; near < before.rows.size() && before.rows[near].y <= y + reach; ++near)
        join_rows(row, before.runs_of(near), reach, forest);
}

/// A range of slices, labelled by one thread with its own set of labels.
class LabelledRange {
public:
    LabelledRange(int64_t lower_slice, int64_t upper_slice) : lower_(lower_slice), upper_(upper_slice) {}

    /// Labels the range. Adds finished words (BitSlab::words) to `words_done`. Stops early if `is_stopped` is set.
    void label(BitSlab& slab, Connectivity connectivity, RunFile* file, HeldBytes& held,
               std::atomic<int64_t>& words_done, const std::atomic<bool>& is_stopped)
    {
        int64_t done = lower_;  // first slice not done yet; skipped slices are empty
        for (int64_t slab_bytes = slab.bytes(); !is_stopped && slab.read(done, upper_); slab_bytes = slab.bytes()) {
            held.change(slab.bytes() - slab_bytes);
            for (int64_t z = slab.lower(); z < slab.upper(); ++z) {
                std::swap(before_, last);
                if (z > done) before_.clear();
                label_slice(slab, z, connectivity);
                if (file != nullptr) file->write(z, last);
                if (z == lower_) first = last;
                count_held(held);
                done = z + 1;
            }
            words_done += slab.words();
        }
        if (done < upper_) last = {};
        before_ = {};
        count_held(held);
    }

    SliceRuns first, last;  ///< first and last slice, still with this range's own labels
    LabelForest forest;
    int64_t foreground_voxels = 0;
    int64_t lower_slice() const { return lower_; }

private:
    void label_slice(BitSlab& slab, int64_t z, Connectivity connectivity)
    {
        last.clear();
        size_t at = 0;
        slab.for_each_row(z, [&](int64_t y, std::span<const uint32_t> ends) {
            for (size_t i = 0; i < ends.size(); i += 2) last.runs.push_back({ends[i], ends[i + 1], NO_LABEL});
            last.rows.push_back({uint32_t(y), uint32_t(last.runs.size())});
            label_row(at, connectivity);
        });
    }

    /// Labels the last row of `last`.
    void label_row(size_t& at, Connectivity connectivity)
    {
        const size_t index = last.rows.size() - 1;
        const int64_t y = last.rows[index].y;
        const std::span<LabelledRun> row = last.runs_of(index);
        if (index > 0 && last.rows[index - 1].y + 1 == y)
            join_rows(row, last.runs_of(index - 1), connectivity == Connectivity::faces ? 0 : 1, forest);
        join_slices(row, y, before_, at, connectivity, forest);
        if (forest.size() + row.size() >= LabelForest::MOST) refuse_labels();
        for (LabelledRun& run : row) {
            if (run.label == NO_LABEL) run.label = forest.add();
            const auto voxels = int64_t(run.end - run.begin);
            forest.voxels(run.label) += voxels;
            foreground_voxels += voxels;
        }
    }

    void count_held(HeldBytes& held)
    {
        const int64_t bytes = first.bytes() + last.bytes() + before_.bytes() + forest.bytes();
        held.change(bytes - held_);
        held_ = bytes;
    }

    int64_t lower_, upper_;
    SliceRuns before_;
    int64_t held_ = 0;
};

// ---- All ranges -----------------------------------------------------------------------------------------------------

/// Everything that computes the labels of voxels on demand.
struct LabelTable {
    LabelForest forest;                    ///< the parent of each provisional label is its final label
    std::vector<int64_t> lower;            ///< first slice of each range
    std::vector<uint32_t> bases;           ///< offset of each range's labels
    std::optional<RunFile> runs{};         ///< all runs, with their ranges' own labels
    std::optional<StoredBlocks> stored{};  ///< blocks that can hold labels; null: all blocks
};

class LabelSource final : public VolumeSource {
public:
    LabelSource(VolumeInfo info, std::shared_ptr<const LabelTable> table)
        : VolumeSource(std::move(info)), table_(std::move(table))
    {}

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        std::ranges::fill(voxels, std::byte{0});
        with_voxel_type(info().type, [&]<class T>(T) {
            SliceRuns slice;
            T* row = reinterpret_cast<T*>(voxels.data());
            for (int64_t z = box.lower.z; z < box.upper.z; ++z) {
                table_->runs->read(z, box.lower.y, box.upper.y, slice);
                const auto after = std::ranges::upper_bound(table_->lower, z);
                const uint32_t base = table_->bases[size_t(after - table_->lower.begin()) - 1];
                for (size_t i = 0; i < slice.rows.size(); ++i)
                    fill_row(slice.runs_of(i), base, box, row + (slice.rows[i].y - box.lower.y) * box.size().x);
                row += box.size().x * box.size().y;
            }
        });
    }

    Size3 block() const override { return table_->stored ? table_->stored->block : Size3(1); }
    std::optional<StoredBlocks> stored_blocks(int level, int64_t most) const override
    {
        if (level != 0 || !table_->stored || int64_t(table_->stored->blocks.size()) > most) return std::nullopt;
        return table_->stored;
    }

private:
    template <class T>
    void fill_row(std::span<const LabelledRun> runs, uint32_t base, const VoxelBox& box, T* row) const
    {
        for (const LabelledRun& run : runs) {
            const int64_t begin = std::max<int64_t>(run.begin, box.lower.x);
            const int64_t end = std::min<int64_t>(run.end, box.upper.x);
            if (begin < end)
                std::fill_n(row + (begin - box.lower.x), end - begin,
                            static_cast<T>(table_->forest.parent(base + run.label)));
        }
    }

    std::shared_ptr<const LabelTable> table_;
};

VoxelType type_for(int64_t labels)
{
    return labels < 256 ? VoxelType::uint8 : labels < 65536 ? VoxelType::uint16 : VoxelType::uint32;
}

class Labelling final : public Components {
public:
    Labelling(const VolumeSource& source, const ComponentOptions& options)
        : source_info_(source.info()), options_(options), table_(std::make_shared<LabelTable>())
    {
        static_cast<void>(voxel_count(source.info()));
        table_->stored = stored_above(source);
        if (options.run_folder) table_->runs.emplace(*options.run_folder, source.info().size.z);
        label_ranges(source);
        join_ranges();
        resolve();
        number();
        table_->forest.drop_counts();
        ranges_.clear();
        if (table_->runs) counts_.run_file_bytes = table_->runs->bytes();
    }

    std::unique_ptr<VolumeSource> labels() const override
    {
        SHVR_CHECK(table_->runs.has_value(), "no folder for runs was given");
        VolumeInfo info = source_info_;
        info.type = type_for(counts_.kept);
        info.format = "components";
        info.warnings.clear();
        return std::make_unique<LabelSource>(std::move(info), table_);
    }

private:
    /// Returns the blocks of a sparse volume that can hold voxels at or above the threshold; null: all blocks.
    std::optional<StoredBlocks> stored_above(const VolumeSource& source) const
    {
        const Size3& size = source.info().size;
        std::optional<StoredBlocks> stored = source.stored_blocks(0, MAX_STORED_BLOCKS);
        if (stored && !(stored->fill >= options_.threshold)) {
            stored->fill = 0.0;  // fill value of the volume of labels
            return stored;
        }
        const int64_t bytes = words_of_row(size.x) * size.y * 8;
        if (bytes > MAX_SLICE_BYTES && stored)
            fail(source.info().name, ": holds ", stored->fill, " wherever nothing is stored, and the threshold is ",
                 options_.threshold, "; expected one above that, or a volume whose slices have at most ",
                 8 * MAX_SLICE_BYTES, " voxels");
        if (bytes > MAX_SLICE_BYTES)
            fail(source.info().name, ": a slice has ", size.x, " x ", size.y, " voxels; expected at most ",
                 8 * MAX_SLICE_BYTES, " in all, or a part of the volume");
        return std::nullopt;
    }

    void label_ranges(const VolumeSource& source)
    {
        const Size3& size = source_info_.size;
        const int threads =
            options_.threads > 0 ? options_.threads : std::max(1, int(std::thread::hardware_concurrency()));
        const ThresholdBits bits(source_info_.type, options_.threshold);
        const BitLayout layout(size, table_->stored);
        std::vector<BitSlab> slabs(size_t(threads), BitSlab(source, bits, layout));
        // Each range consists of whole blocks, so that no block is decoded twice.
        const int64_t block = std::min(source.block().z, size.z);
        const int64_t wanted = threads == 1 ? 1 : threads * RANGES_PER_THREAD;
        const int64_t thickness =
            (std::max((size.z + wanted - 1) / wanted, THINNEST_RANGE) + block - 1) / block * block;
        for (int64_t z = 0; z < size.z; z += thickness) ranges_.emplace_back(z, std::min(size.z, z + thickness));

        HeldBytes held;
        std::atomic<int64_t> words_done = 0;
        const auto words = double(std::max<int64_t>(layout.words(), 1));
        std::atomic<bool> is_stopped = false;
        WorkPool pool(threads, [&] {
            try {
                tell(options_.progress, double(words_done) / words);
            } catch (...) {
                is_stopped = true;  // makes the other threads stop soon; a range can take long
                throw;
            }
        });
        RunFile* const file = table_->runs ? &*table_->runs : nullptr;
        pool.run(int64_t(ranges_.size()), [&](int64_t task, int worker) {
            ranges_[size_t(task)].label(slabs[size_t(worker)], options_.connectivity, file, held, words_done,
                                        is_stopped);
        });
        counts_.peak_bytes = held.peak();
    }

    /// Merges the forests of all ranges, and joins the last slice of each range to the first slice of the next one.
    void join_ranges()
    {
        LabelForest& forest = table_->forest;
        SliceRuns before;
        for (LabelledRange& range : ranges_) {
            counts_.foreground_voxels += range.foreground_voxels;
            const uint64_t base = forest.append(std::move(range.forest));
            if (forest.size() > LabelForest::MOST) refuse_labels();
            table_->lower.push_back(range.lower_slice());
            table_->bases.push_back(uint32_t(base));
            for (SliceRuns* slice : {&range.first, &range.last})
                for (LabelledRun& run : slice->runs) run.label += uint32_t(base);
            size_t at = 0;
            for (size_t i = 0; i < range.first.rows.size(); ++i)
                join_slices(range.first.runs_of(i), range.first.rows[i].y, before, at, options_.connectivity, forest);
            before = std::move(range.last);
        }
        counts_.provisional = int64_t(forest.size());
        counts_.forest_bytes = forest.bytes();
    }

    /// Makes each label a direct child of its component's smallest label, which also receives all voxel counts.
    void resolve()
    {
        LabelForest& forest = table_->forest;
        for (uint64_t i = 0; i < forest.size(); ++i) {
            const auto label = uint32_t(i);
            const uint32_t root = forest.parent(forest.parent(label));
            if (root == label) continue;
            forest.parent(label) = root;
            forest.voxels(root) += std::exchange(forest.voxels(label), 0);
        }
    }

    /// Orders components by size, largest first; components of equal size by their first voxel.
    struct Larger {
        bool operator()(const Component& a, const Component& b) const
        {
            return a.voxels != b.voxels ? a.voxels > b.voxels : a.label < b.label;
        }
    };
    /// The `most` largest components that `visit` reports.
    template <class Visit>
    static std::vector<Component> largest_of(size_t most, const Visit& visit)
    {
        std::vector<Component> heap;  // min-heap
        visit([&](const Component& component) {
            if (heap.size() == most && !Larger{}(component, heap.front())) return;
            heap.push_back(component);
            std::ranges::push_heap(heap, Larger{});
            if (heap.size() <= most) return;
            std::ranges::pop_heap(heap, Larger{});
            heap.pop_back();
        });
        std::ranges::sort(heap, Larger{});
        return heap;
    }

    /// Replaces provisional labels by final ones.
    void number()
    {
        LabelForest& forest = table_->forest;
        const auto for_each_root = [&](const auto& visit) {
            for (uint64_t i = 0; i < forest.size(); ++i) {
                const auto label = uint32_t(i);
                if (forest.voxels(label) > 0) visit(Component{label, forest.voxels(label)});
            }
        };
        const auto most = size_t(options_.max_components);
        std::optional<Component> smallest_kept;
        if (most > 0) {
            const std::vector<Component> kept = largest_of(most, for_each_root);
            if (kept.size() == most) smallest_kept = kept.back();
        }
        const auto is_kept = [&](const Component& component) {
            return component.voxels >= options_.fewest_voxels &&
                   (!smallest_kept || !Larger{}(*smallest_kept, component));
        };
        counts_.largest = largest_of(MAX_LARGEST_LISTED, [&](const auto& visit) {
            for (uint64_t i = 0; i < forest.size(); ++i) {
                const auto label = uint32_t(i);
                const int64_t voxels = forest.voxels(label);
                if (voxels == 0) {
                    forest.parent(label) = forest.parent(forest.parent(label));  // the final label, stored at the root
                    continue;
                }
                ++counts_.found;
                counts_.largest_voxels = std::max(counts_.largest_voxels, voxels);
                const bool stays = is_kept({label, voxels});
                forest.parent(label) = stays ? uint32_t(++counts_.kept) : 0;
                if (!stays) continue;
                counts_.kept_voxels += voxels;
                visit(Component{forest.parent(label), voxels});
            }
        });
    }

    VolumeInfo source_info_;
    ComponentOptions options_;
    std::shared_ptr<LabelTable> table_;
    std::deque<LabelledRange> ranges_;
};

}  // namespace

std::unique_ptr<Components> find_components(const VolumeSource& source, const ComponentOptions& options)
{
    SHVR_CHECK(!std::isnan(options.threshold) && options.fewest_voxels >= 1 && options.max_components >= 0);
    return std::make_unique<Labelling>(source, options);
}

}  // namespace shvr

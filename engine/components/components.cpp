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
#include "engine/base/waits/work_pool.h"
#include "engine/components/component_part.h"
#include "engine/components/labelled_range.h"
#include "engine/volume/voxel_dispatch.h"

namespace shvr {
namespace {

// ---- All ranges -----------------------------------------------------------------------------------------------------

/// Everything that computes the labels of voxels on demand.
struct LabelTable {
    LabelNumbers numbers;                  ///< the final label of each provisional one
    std::vector<int64_t> lower;            ///< first slice of each range
    std::vector<uint32_t> bases;           ///< offset of each range's labels
    std::deque<RunFile> runs{};            ///< all runs, with their ranges' own labels; ascending
    std::optional<StoredBlocks> stored{};  ///< blocks that can hold labels; null: all blocks

    const RunFile& runs_of(int64_t z) const
    {
        size_t file = runs.size() - 1;
        while (file > 0 && runs[file].lower() > z) --file;
        return runs[file];
    }
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
            std::vector<LabelledRun> runs;
            T* row = reinterpret_cast<T*>(voxels.data());
            for (int64_t z = box.lower.z; z < box.upper.z; ++z) {
                table_->runs_of(z).read(z, box.lower.y, box.upper.y, slice);
                const auto after = std::ranges::upper_bound(table_->lower, z);
                const uint32_t base = table_->bases[size_t(after - table_->lower.begin()) - 1];
                for (size_t i = 0; i < slice.rows.size(); ++i) {
                    slice.get_row(i, runs);
                    fill_row(runs, base, box, row + (slice.rows[i].y - box.lower.y) * box.size().x);
                }
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
            // A piece of another process may be damaged.
            if (uint64_t{base} + run.label >= table_->numbers.size())
                fail(info().name, ": a run has label ", run.label, "; expected one that its task has made");
            const int64_t begin = std::max<int64_t>(run.begin, box.lower.x);
            const int64_t end = std::min<int64_t>(run.end, box.upper.x);
            if (begin < end)
                std::fill_n(row + (begin - box.lower.x), end - begin,
                            static_cast<T>(table_->numbers[base + run.label]));
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
    Labelling(const VolumeSource& source, const ComponentOptions& options) : Labelling(source, options, nullptr)
    {
        if (options.run_folder) table_->runs.emplace_back(*options.run_folder, 0, source.info().size.z);
        SlicesDone done = label_slices(source, options_, table_->stored, {0, source.info().size.z}, run_file());
        counts_.peak_bytes = done.peak_bytes;
        finish(done.ranges);
    }
    /// Joins what other processes labelled.
    Labelling(const VolumeSource& source, const ComponentOptions& options, const std::vector<ComponentPart>& parts)
        : Labelling(source, options, nullptr)
    {
        std::deque<LabelledRange> ranges;
        int64_t next = 0;
        for (const ComponentPart& part : parts) {
            if (part.slices().lower != next)
                fail(source.info().name, ": a part begins at slice ", part.slices().lower, "; expected ", next,
                     ", where the one before it ends");
            next = part.slices().upper;
            std::deque<LabelledRange> read = part.read_ranges();
            for (LabelledRange& range : read) ranges.push_back(std::move(range));
            if (options.run_folder) part.add_runs(table_->runs);
        }
        if (next != source.info().size.z)
            fail(source.info().name, ": the parts end at slice ", next, "; expected ", source.info().size.z);
        finish(ranges);
    }

    std::unique_ptr<VolumeSource> labels() const override
    {
        SHVR_CHECK(!table_->runs.empty(), "no folder for runs was given");
        VolumeInfo info = source_info_;
        info.type = type_for(counts_.kept);
        info.format = "components";
        info.warnings.clear();
        return std::make_unique<LabelSource>(std::move(info), table_);
    }

private:
    Labelling(const VolumeSource& source, const ComponentOptions& options, std::nullptr_t)
        : source_info_(source.info()), options_(options), table_(std::make_shared<LabelTable>())
    {
        static_cast<void>(voxel_count(source.info()));
        table_->stored = stored_above(source, options.threshold);
    }

    RunFile* run_file() { return table_->runs.empty() ? nullptr : &table_->runs.front(); }

    void finish(std::deque<LabelledRange>& ranges)
    {
        join_ranges(ranges);
        resolve();
        number();
        table_->numbers = forest_.take_parents();
        for (const RunFile& runs : table_->runs) counts_.run_file_bytes += runs.bytes();
    }

    /// Merges the forests of all ranges, and joins the last slice of each range to the first slice of the next one.
    void join_ranges(std::deque<LabelledRange>& ranges)
    {
        LabelForest& forest = forest_;
        SliceRuns before;
        RowJoiner joiner;
        const uint32_t reach = options_.connectivity == Connectivity::faces ? 0 : 1;
        for (LabelledRange& range : ranges) {
            counts_.foreground_voxels += range.foreground_voxels;
            const uint64_t base = forest.append(std::move(range.forest));
            if (forest.size() > LabelForest::MOST) refuse_labels();
            table_->lower.push_back(range.lower_slice());
            table_->bases.push_back(uint32_t(base));
            for (SliceRuns* slice : {&range.first, &range.last})
                for (uint32_t& label : slice->labels) label += uint32_t(base);
            RowFinder finder(before);
            for (size_t i = 0; i < range.first.rows.size(); ++i)
                for (const auto& [dy, dz] : rows_before(options_.connectivity))
                    if (dz < 0)
                        if (const auto found = finder.find(range.first.rows[i].y + dy))
                            joiner.join(range.first, i, before, *found, reach, forest);
            before = std::move(range.last);
        }
        counts_.provisional = int64_t(forest.size());
        counts_.forest_bytes = forest.bytes();
    }

    /// Makes each label a direct child of its component's smallest label, which also receives all voxel counts.
    void resolve()
    {
        LabelForest& forest = forest_;
        for (uint64_t i = 0; i < forest.size(); ++i) {
            const auto label = uint32_t(i);
            const uint32_t root = forest.parent(forest.parent(label));
            if (root == label) continue;
            forest.parent(label) = root;
            forest.add_voxels(root, forest.take_voxels(label));
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
        LabelForest& forest = forest_;
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
    LabelForest forest_;
    std::shared_ptr<LabelTable> table_;
};

}  // namespace

std::unique_ptr<Components> find_components(const VolumeSource& source, const ComponentOptions& options)
{
    SHVR_CHECK(!std::isnan(options.threshold) && options.fewest_voxels >= 1 && options.max_components >= 0);
    return std::make_unique<Labelling>(source, options);
}

std::unique_ptr<Components> join_components(const VolumeSource& source, const ComponentOptions& options,
                                            const std::vector<ComponentPart>& parts)
{
    return std::make_unique<Labelling>(source, options, parts);
}

}  // namespace shvr

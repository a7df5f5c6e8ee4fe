#pragma once
// A range of slices, labelled by one thread with its own set of labels, and the joining of neighbouring ranges. For
// components.cpp and component_part.cpp.

#include <algorithm>
#include <atomic>
#include <limits>
#include <utility>

#include "engine/base/error.h"
#include "engine/components/bit_slab.h"
#include "engine/components/component_runs.h"
#include "engine/components/components.h"
#include "engine/components/label_forest.h"

namespace shvr {

inline constexpr uint32_t NO_LABEL = std::numeric_limits<uint32_t>::max();

[[noreturn]] inline void refuse_labels()
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
inline void join_rows(std::span<LabelledRun> row, std::span<const LabelledRun> before, uint32_t reach,
                      LabelForest& forest)
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
inline void join_slices(std::span<LabelledRun> row, int64_t y, SliceRuns& before, size_t& at, Connectivity connectivity,
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
    int64_t upper_slice() const { return upper_; }

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

}  // namespace shvr

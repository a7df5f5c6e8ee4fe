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
#include "engine/components/touching_runs.h"

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
        for (auto other = first; other != before.end() && other->begin < run.end + reach; ++other)
            forest.join_into(run.label, other->label, NO_LABEL);
    }
}

/// Joins rows of slices by their runs, which is slower than by their bits, but needs no bits.
class RowJoiner {
public:
    void join(SliceRuns& slice, size_t row, const SliceRuns& other, size_t other_row, uint32_t reach,
              LabelForest& forest)
    {
        slice.get_row(row, runs_);
        other.get_row(other_row, before_);
        join_rows(runs_, before_, reach, forest);
        const std::span<uint32_t> labels = slice.labels_of(row);
        for (size_t i = 0; i < labels.size(); ++i) labels[i] = runs_[i].label;
    }

private:
    std::vector<LabelledRun> runs_, before_;
};

/// Finds a slice's rows one after another.
class RowFinder {
public:
    explicit RowFinder(const SliceRuns& slice) : slice_(slice) {}

    /// Returns the index of row y, if it has runs. `y` is at most 2 less than in earlier calls.
    std::optional<size_t> find(int64_t y)
    {
        while (at_ > 0 && slice_.rows[at_ - 1].y >= y) --at_;
        while (at_ < slice_.rows.size() && slice_.rows[at_].y < y) ++at_;
        return at_ < slice_.rows.size() && slice_.rows[at_].y == y ? std::optional(at_) : std::nullopt;
    }

private:
    const SliceRuns& slice_;
    size_t at_ = 0;
};

/// Where the rows before a row lie that its runs can touch.
struct RowBefore {
    int64_t dy, dz;
};
inline std::span<const RowBefore> rows_before(Connectivity connectivity)
{
    static constexpr RowBefore ALL[] = {{-1, 0}, {0, -1}, {-1, -1}, {1, -1}};
    return std::span(ALL).first(connectivity == Connectivity::faces ? 2 : 4);
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
        RowFinder before(before_);
        slab.for_each_row(z, [&](const BitSlab::Row& row) {
            last.add_row(uint32_t(row.y), row.ends, NO_LABEL);
            const size_t index = last.rows.size() - 1;
            for (const auto& [dy, dz] : rows_before(connectivity)) {
                if (dz < 0) {
                    if (const std::optional<size_t> found = before.find(row.y + dy))
                        join(row, before_, *found, row.words_at(dy, dz), connectivity);
                } else if (index > 0 && last.rows[index - 1].y == row.y + dy) {
                    join(row, last, index - 1, row.words_at(dy, dz), connectivity);
                }
            }
            finish_row(row);
        });
    }

    /// Joins the last row of `last` with another row, whose bits are `words` unless null.
    void join(const BitSlab::Row& row, SliceRuns& other, size_t other_row, const uint64_t* words,
              Connectivity connectivity)
    {
        const uint32_t reach = connectivity == Connectivity::faces ? 0 : 1;
        if (words == nullptr) return joiner_.join(last, last.rows.size() - 1, other, other_row, reach, forest);
        auto run = uint32_t(last.first_of(last.rows.size() - 1)), other_run = uint32_t(other.first_of(other_row));
        const uint64_t* own = row.words;
        for (const BitLayout::Columns& columns : row.strip->columns) {
            const auto count = size_t(words_of_row(columns.upper - columns.lower));
            for_each_touching(own, words, count, reach > 0, run, other_run, [&](uint32_t a, uint32_t b) {
                forest.join_into(last.labels[a], other.labels[b], NO_LABEL);
            });
            own += count;
            words += count;
        }
    }

    /// Gives the runs of the last row of `last` that touch no other a label, and counts voxels.
    void finish_row(const BitSlab::Row& row)
    {
        const std::span<uint32_t> labels = last.labels_of(last.rows.size() - 1);
        if (forest.size() + labels.size() >= LabelForest::MOST) refuse_labels();
        forest.add_in_place_of(NO_LABEL, labels);
        int64_t sum = 0;
        for (size_t i = 0; i < labels.size(); ++i) {
            const auto voxels = int64_t(row.ends[2 * i + 1] - row.ends[2 * i]);
            forest.add_voxels(labels[i], voxels);
            sum += voxels;
        }
        foreground_voxels += sum;
    }

    void count_held(HeldBytes& held)
    {
        const int64_t bytes = first.bytes() + last.bytes() + before_.bytes() + forest.bytes();
        held.change(bytes - held_);
        held_ = bytes;
    }

    int64_t lower_, upper_;
    SliceRuns before_;
    RowJoiner joiner_;
    int64_t held_ = 0;
};

}  // namespace shvr

#pragma once
// The labelled runs of whole slices, and a file that stores them while a volume is being labelled. For components.cpp.

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "engine/base/file.h"
#include "engine/volume/volume.h"

namespace shvr {

/// Voxels [begin, end) of a row.
struct LabelledRun {
    uint32_t begin = 0, end = 0, label = 0;
};

/// The runs of one slice, row by row; rows without runs have no entry.
struct SliceRuns {
    struct Row {
        uint32_t y = 0;
        uint32_t end = 0;        ///< one past the row's last index in `labels`; its first is the previous row's `end`
        uint64_t steps_end = 0;  ///< the same of `steps`
    };
    std::vector<Row> rows{};  ///< ascending
    /// Distances from one end of a run to the next, from 0 on: a byte, or LONG_STEP and the distance in four bytes.
    std::vector<uint8_t> steps{};
    std::vector<uint32_t> labels{};
    static constexpr uint8_t LONG_STEP = 255;

    void clear()
    {
        rows.clear();
        steps.clear();
        labels.clear();
    }
    /// Appends a row. `ends` has the first voxel of each run and the voxel after its last, ascending; all runs get the
    /// same label.
    void add_row(uint32_t y, std::span<const uint32_t> ends, uint32_t label);
    /// Replaces `runs` by the runs of rows[i]. Runs end early, or are missing, where the steps are damaged.
    void get_row(size_t i, std::vector<LabelledRun>& runs) const;
    size_t first_of(size_t i) const { return i == 0 ? 0 : rows[i - 1].end; }
    std::span<uint32_t> labels_of(size_t i)
    {
        return std::span(labels).subspan(first_of(i), rows[i].end - first_of(i));
    }
    int64_t bytes() const
    {
        return int64_t(rows.capacity() * sizeof(Row) + steps.capacity() + labels.capacity() * sizeof(uint32_t));
    }
};

/// An unnamed temporary file, which leaves nothing behind even after a crash. Any thread may write and read different
/// slices at once; each slice is written once, before it is read.
class RunFile {
public:
    /// Where the rows of a slice are in the file; their steps and labels follow them.
    struct Place {
        int64_t offset = 0;
        uint32_t rows = 0;  ///< 0: no runs
        uint32_t unused = 0;
    };
    /// Creates the file in `folder`, for `slices` slices from slice `lower` on. Fails if no file can be created there.
    RunFile(const std::filesystem::path& folder, int64_t lower, int64_t slices);
    /// Opens a file that another process has written, for reading.
    RunFile(const std::filesystem::path& file, int64_t lower, std::vector<Place> places);

    void write(int64_t z, const SliceRuns& slice);
    /// Reads rows [lower, upper) of a slice; none where the file does not have the slice.
    void read(int64_t z, int64_t lower, int64_t upper, SliceRuns& slice) const;
    int64_t lower() const { return lower_; }  ///< first slice
    int64_t bytes() const { return end_; }

private:
    void get(std::span<std::byte> bytes, int64_t at) const;

    std::filesystem::path folder_;
    FileDescriptor file_;
    int64_t lower_ = 0;
    std::vector<Place> places_;  ///< by slice, from `lower_` on
    std::atomic<int64_t> end_ = 0;
};

}  // namespace shvr

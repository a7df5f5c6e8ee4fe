#pragma once
// The labelled runs of whole slices, and a file that keeps them while a volume is labelled. For components.cpp.

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

/// Runs of consecutive rows: those of row i are [rows[i], rows[i + 1]).
struct SliceRuns {
    std::vector<uint32_t> rows{};
    std::vector<LabelledRun> runs{};

    std::span<LabelledRun> row(int64_t y)
    {
        const auto at = size_t(y);
        return std::span(runs).subspan(rows[at], rows[at + 1] - rows[at]);
    }
    int64_t bytes() const
    {
        return int64_t(rows.capacity() * sizeof(uint32_t) + runs.capacity() * sizeof(LabelledRun));
    }
};

/// An unnamed temporary file, so that nothing is left behind whatever happens. Any thread may write and read different
/// slices at once; each slice is written once, before it is read.
class RunFile {
public:
    /// In `folder`, for volumes of `size`. Fails if no file can be created there.
    RunFile(const std::filesystem::path& folder, const Size3& size);

    void write(int64_t z, const SliceRuns& slice);
    /// Rows [lower, upper) of a slice.
    void read(int64_t z, int64_t lower, int64_t upper, SliceRuns& slice) const;
    int64_t bytes() const { return end_; }

private:
    std::filesystem::path folder_;
    FileDescriptor file_;
    int64_t rows_bytes_;           ///< size of the row table before the runs of a slice
    std::vector<int64_t> places_;  ///< file offsets of slices; -1: no runs
    std::atomic<int64_t> end_ = 0;
};

}  // namespace shvr

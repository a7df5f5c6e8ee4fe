#pragma once
// Speed against error of other features: blurring before an import, and the labelling of components. One thread calls
// these.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tools/report/plot.h"

namespace shvr::bench {

struct SweepRow {
    std::string series, setting;  ///< "uint8", "sigma 2"
    double share = 0.0;           ///< percentage of open voxels; only for labelling
    double ns_per_voxel = 0.0;    ///< median
    double error = 0.0;           ///< blur: RMS, relative to the range of values; labelling: voxels with another label
};
struct Sweep {
    std::string name, what;
    std::string error;  ///< meaning of `SweepRow::error`
    std::vector<SweepRow> rows;
    report::Plot plot;
    std::string svg = {};    ///< replaces `plot` if it was drawn elsewhere
    std::string table = {};  ///< likewise: CSV that replaces `rows`
};

struct SweepOptions {
    bool quick = false;
    int threads = 2;
    std::filesystem::path scratch;    ///< a folder for temporary files
    std::function<void()> poll = {};  ///< may throw, which ends the work
};

/// Measures blur time by sigma and voxel type; the error is the difference from a direct sum, in double, up to 8 sigma.
Sweep sweep_blur(const SweepOptions& options);
/// Measures labelling time by fraction of open voxels and by connectivity; compares with breadth-first labelling.
Sweep sweep_labelling(const SweepOptions& options);

/// The sweep's own CSV.
std::string csv_of(const Sweep& sweep);

}  // namespace shvr::bench

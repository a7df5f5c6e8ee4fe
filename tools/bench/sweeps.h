#pragma once
// Measures speed against error of features other than drawing: blurring before an import, and labelling of components.
// Call from one thread.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tools/report/plot.h"

namespace shvr::bench {

struct SweepRow {
    std::string series, setting;  ///< "uint8", "sigma 2"
    double share = 0.0;           ///< percentage of voxels that belong to components; only for labelling
    double ns_per_voxel = 0.0;    ///< median
    double error = 0.0;           ///< blur: RMS, relative to the range of values; labelling: voxels with a wrong label
};
struct Sweep {
    std::string name, what;
    std::string error;  ///< meaning of `SweepRow::error`
    std::vector<SweepRow> rows;
    report::Plot plot;
    std::string svg = {};    ///< a finished plot that is used in place of `plot`; empty: none
    std::string table = {};  ///< likewise: CSV that replaces `rows`
};

struct SweepOptions {
    bool quick = false;
    int threads = 2;
    std::filesystem::path scratch;    ///< a folder for temporary files
    std::function<void()> poll = {};  ///< may throw, which ends the work
};

/// Measures blur time by sigma and voxel type. Errors are relative to a direct sum up to 8 sigma, in double.
Sweep sweep_blur(const SweepOptions& options);
/// Measures labelling time by share of open voxels and connectivity; checks the labels by breadth-first search.
Sweep sweep_labelling(const SweepOptions& options);

/// The sweep's own CSV.
std::string csv_of(const Sweep& sweep);

}  // namespace shvr::bench

#pragma once
// Speed against error beside pictures: blurring before an import, and the labelling of components. One thread calls
// these.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tools/report/plot.h"

namespace shvr::bench {

struct SweepRow {
    std::string series, setting;  ///< "uint8", "sigma 2"
    double share = 0.0;           ///< of voxels that are open, in percent; labelling alone
    double ns_per_voxel = 0.0;    ///< median
    double error = 0.0;           ///< blur: RMS, of the range of values; labelling: voxels with another label
};
struct Sweep {
    std::string name, what;
    std::string error;  ///< what `SweepRow::error` is
    std::vector<SweepRow> rows;
    report::Plot plot;
    std::string svg = {};    ///< of one that was drawn elsewhere, instead of `plot`
    std::string table = {};  ///< likewise: CSV, instead of `rows`
};

struct SweepOptions {
    bool quick = false;
    int threads = 2;
    std::filesystem::path scratch;    ///< a folder for temporary files
    std::function<void()> poll = {};  ///< may throw, which ends the work
};

/// Sigma by type of voxel, against a direct sum in double to 8 sigma.
Sweep sweep_blur(const SweepOptions& options);
/// Share of open voxels by connectivity, against breadth-first labelling.
Sweep sweep_labelling(const SweepOptions& options);

/// The sweep's own CSV.
std::string csv_of(const Sweep& sweep);

}  // namespace shvr::bench

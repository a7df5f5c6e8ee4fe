#pragma once
// Results of algorithms that annotate without a hand, as tools/study/baselines.py writes them. Any thread.

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/study/rows.h"

namespace shvr {

struct BaselineRow {
    std::string method;
    double noise = 0.0;
    uint32_t seed = 0;
    std::string skipped;                  ///< why there is no result; empty if there is one
    std::array<double, OUTCOMES> values;  ///< NaN where the method has no such outcome
    double operator[](Outcome outcome) const { return values[size_t(outcome)]; }
};

/// Columns: method, noise, seed, skipped, and names of `outcome_columns()`, in any order; a missing outcome is NaN.
/// Fails with a sentence that names file, line and column.
std::vector<BaselineRow> read_baselines(const std::filesystem::path& file);

}  // namespace shvr

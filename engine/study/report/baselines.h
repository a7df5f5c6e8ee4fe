#pragma once
// Results of algorithms that annotate without a person, as tools/study/baselines.py writes them. Any thread.

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
    std::string skipped;                  ///< the reason why there is no result; empty if there is one
    std::array<double, OUTCOMES> values;  ///< NaN if the method does not produce this outcome
    double operator[](Outcome outcome) const { return values[size_t(outcome)]; }
};

/// Columns: method, noise, seed, skipped, and the names of `outcome_columns()`, in any order. An outcome without a
/// column is NaN. Fails with a message that names file, line and column.
std::vector<BaselineRow> read_baselines(const std::filesystem::path& file);

}  // namespace shvr

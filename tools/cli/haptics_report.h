#pragma once
// The output of `shvr haptics replay` and `bench`.

#include <string>
#include <vector>

#include "haptics/replay/replay.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

/// {p50, p99, max} in microseconds, from nanoseconds.
Json quantiles_us(std::vector<uint64_t> nanoseconds);
/// `unit`: of the volume's lengths. Values in micrometres are null if it is not a unit of length.
Json report_of(const ReplayResult& result, const std::string& unit);

/// Measures speed against error of the proxy, both from sample points and exact, for several ball sizes. Writes CSV,
/// and a plot if `svg` is not empty. Returns a sentence for each row.
std::vector<std::string> sweep_proxy(const std::string& csv, const std::string& svg, LongWork& work);

void add_haptics_bench(CLI::App& haptics);
void add_haptics_devices(CLI::App& haptics);

}  // namespace shvr::cli

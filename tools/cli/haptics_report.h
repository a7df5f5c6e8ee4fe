#pragma once
// The output of `shvr haptics replay` and `bench`.

#include <string>
#include <vector>

#include "haptics/replay/replay.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

/// {p50, p99, max} in microseconds, from nanoseconds.
Json quantiles_us(std::vector<uint64_t> nanoseconds);
/// `unit`: the volume's unit of length. If it is no physical unit, values in micrometres are null.
Json report_of(const ReplayResult& result, const std::string& unit);

/// Measures speed against error of the proxy, from sample points and from exact integration, for several ball sizes.
/// Writes CSV, and a plot unless `svg` is empty. Returns a sentence for each row.
std::vector<std::string> sweep_proxy(const std::string& csv, const std::string& svg, LongWork& work);

void add_haptics_bench(CLI::App& haptics);
void add_haptics_devices(CLI::App& haptics);

}  // namespace shvr::cli

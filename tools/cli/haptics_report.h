#pragma once
// What `shvr haptics replay` and `bench` print.

#include <string>
#include <vector>

#include "haptics/replay/replay.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

/// {p50, p99, max} in microseconds, of nanoseconds.
Json quantiles_us(std::vector<uint64_t> nanoseconds);
/// `unit` of the volume's lengths; micrometres are null where it is no length.
Json report_of(const ReplayResult& result, const std::string& unit);

/// Speed against error of the proxy, by points and exactly, over sizes of the ball: CSV, and a plot where `svg` is not
/// empty. Returns a sentence for each row.
std::vector<std::string> sweep_proxy(const std::string& csv, const std::string& svg, LongWork& work);

void add_haptics_bench(CLI::App& haptics);
void add_haptics_devices(CLI::App& haptics);

}  // namespace shvr::cli

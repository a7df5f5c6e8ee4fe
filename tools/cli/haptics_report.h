#pragma once
// What `shvr haptics replay` and `bench` print.

#include <string>

#include "haptics/replay/replay.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

/// {p50, p99, max} in microseconds, of nanoseconds.
Json quantiles_us(std::vector<uint64_t> nanoseconds);
/// `unit` of the volume's lengths; micrometres are null where it is no length.
Json report_of(const ReplayResult& result, const std::string& unit);

void add_haptics_bench(CLI::App& haptics);
void add_haptics_devices(CLI::App& haptics);

}  // namespace shvr::cli

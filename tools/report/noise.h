#pragma once
// Estimates how much the medians of equal work differ by chance. Pure; any thread.

#include <cstddef>
#include <optional>

namespace shvr::report {

/// Minimum number of measured times for an estimate of the noise.
constexpr size_t MIN_TIMES = 3;

/// Returns the noise of the median of `count` measured times: half the distance from the minimum to the 95th
/// percentile, enlarged for small counts, since few values spread less than many. Null if `count` is too small.
std::optional<double> noise_of(double minimum, double p95, size_t count);

/// Returns the root of the sum of both squares. Medians of equal work with ordinary noise differ by more than this in
/// about one case in a thousand.
std::optional<double> noise_of_both(const std::optional<double>& a, const std::optional<double>& b);

}  // namespace shvr::report

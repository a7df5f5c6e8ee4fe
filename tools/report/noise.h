#pragma once
// Estimates how far the medians of equal work differ by chance. Pure; any thread.

#include <cstddef>
#include <optional>

namespace shvr::report {

/// The minimum number of measured times that noise can be estimated from.
constexpr size_t MIN_TIMES = 3;

/// Returns the noise of the median of `count` measured times: half the distance from minimum to 95th percentile,
/// enlarged for small counts, since few values spread less than many. Null if there are too few.
std::optional<double> noise_of(double minimum, double p95, size_t count);

/// Returns the root of the sum of both squares. For pairs of equal work with ordinary noise, the medians differ by more
/// in about one case in a thousand.
std::optional<double> noise_of_both(const std::optional<double>& a, const std::optional<double>& b);

}  // namespace shvr::report

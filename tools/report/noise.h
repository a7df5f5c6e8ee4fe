#pragma once
// How far the medians of equal work lie apart by chance. Pure; any thread.

#include <cstddef>
#include <optional>

namespace shvr::report {

/// So many times tell what their noise is.
constexpr size_t FEWEST_TIMES = 3;

/// The noise of the median of `count` times: half the way from their minimum to their 95th percentile, and more where
/// they are few, since few lie closer together than many. Nothing where there are fewer than FEWEST_TIMES.
std::optional<double> noise_of(double minimum, double p95, size_t count);

/// Both together, as the sides of a right angle. Of a thousand pairs of equal work with ordinary noise, the medians of
/// about one differ by more.
std::optional<double> noise_of_both(const std::optional<double>& a, const std::optional<double>& b);

}  // namespace shvr::report

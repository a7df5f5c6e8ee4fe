#include "tools/report/noise.h"

#include <cmath>
#include <iterator>

namespace shvr::report {

namespace {

/// Factors for 3, 4, ... measured times, on half the distance from the minimum to the 95th percentile, such that one
/// pair in a thousand of equal work differs by more. Each is the larger of the factors for normal and exponential noise
/// (tests/unit/instruments/noise_test.cpp). From 9 times on, the factor is 1.
constexpr double FOR_FEW[] = {5.8, 2.9, 2.0, 1.55, 1.35, 1.15};

}  // namespace

std::optional<double> noise_of(double minimum, double p95, size_t count)
{
    if (count < MIN_TIMES) return std::nullopt;
    const size_t row = count - MIN_TIMES;
    return 0.5 * (p95 - minimum) * (row < std::size(FOR_FEW) ? FOR_FEW[row] : 1.0);
}

std::optional<double> noise_of_both(const std::optional<double>& a, const std::optional<double>& b)
{
    if (!a || !b) return std::nullopt;
    return std::hypot(*a, *b);
}

}  // namespace shvr::report

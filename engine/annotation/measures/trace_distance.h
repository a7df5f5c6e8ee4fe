#pragma once
// Measures the distance of a trace from the truth, along the trace's length. Any thread may call this.

#include <optional>

#include "engine/annotation/measures/trace_course.h"

namespace shvr {

/// Statistics of the distance from positions of the trace to the nearest position of the truth.
struct TraceDistance {
    /// From 16 samples per internode; exact where the nearest internode of the truth does not change between samples.
    double root_mean_square = 0.0;
    double greatest = 0.0;  ///< at most one part in 10^9 below the true maximum, apart from rounding
};
/// Null if the trace has no length, or if the truth has no internodes.
std::optional<TraceDistance> distance_from(const TraceGraph& trace, const TraceCourse& truth);

}  // namespace shvr

#pragma once
// Measures how far a trace is from the truth, along its length. Any thread may call this.

#include <optional>

#include "engine/annotation/measures/trace_course.h"

namespace shvr {

/// Statistics of the distance from the trace's positions to the nearest position of the truth.
struct TraceDistance {
    /// Computed from 16 samples per internode; exact if the nearest internode of the truth does not change in between.
    double root_mean_square = 0.0;
    double greatest = 0.0;  ///< greatest distance; apart from rounding, too small by at most one part in 10^9
};
/// Null if the trace has no length or the truth no internodes.
std::optional<TraceDistance> distance_from(const TraceGraph& trace, const TraceCourse& truth);

}  // namespace shvr

// Comparison of two traces as graphs. trace_score.h defines the counts.

#include "engine/annotation/measures/trace_distance.h"
#include "engine/annotation/measures/trace_errors.h"
#include "engine/annotation/measures/trace_score.h"

namespace shvr {

TraceComparison compare(const TraceGraph& trace, const TraceGraph& truth, double slack)
{
    const TraceCourse course(truth);
    const TraceMatch match(trace, truth, course, slack);
    const TraceFollow follow(truth, course, match, slack);
    TraceComparison result;
    result.segments_total = int64_t(course.segments().size());
    for (size_t s = 0; s < course.segments().size(); ++s) result.segments_found += match.is_found(s);
    result.wrong = int64_t(follow.wrong().size());
    result.doubled = int64_t(follow.doubled().size());
    const TraceErrors errors({trace, truth, course, match, follow, slack});
    result.spurs = errors.spurs();
    result.superfluous = errors.superfluous();
    result.breaks = errors.count_breaks();
    result.gaps = errors.count_gaps();
    if (const std::optional<TraceDistance> distance = distance_from(trace, course)) {
        result.centreline_rms = distance->root_mean_square;
        result.centreline_most = distance->greatest;
    }
    return result;
}

}  // namespace shvr

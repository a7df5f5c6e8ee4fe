#include "engine/study/score.h"

#include "engine/annotation/measures/trace_score.h"

namespace shvr {

namespace {

using Values = std::array<double, OUTCOMES>;

void put(Values& values, Outcome outcome, std::optional<double> value)
{
    if (value) values[size_t(outcome)] = *value;
}

void put(Values& values, const BallScores& scores, Outcome mean, Outcome out, Outcome total)
{
    put(values, mean, scores.mean);
    put(values, out, double(scores.out));
    put(values, total, double(scores.total));
}

}  // namespace

void put_scores(const StudyScene& scene, const Document& document, StudyRow& row)
{
    Values& values = row.values;
    if (row.condition.task == StudyTask::paint) {
        put(values, Outcome::dice_partial, dice_of(scene.partial_mask(), document.mask).painted);
        put(values, Outcome::dice_full, dice_of(scene.full_mask(), document.mask).painted);
        return;
    }
    const glm::dvec3 spacing = scene.volume().info().spacing;
    put(values, score_nodes(document.trace, scene.full_mask(), spacing), Outcome::node_score, Outcome::nodes_out,
        Outcome::nodes);
    put(values, score_internodes(document.trace, scene.full_mask(), spacing), Outcome::internode_score,
        Outcome::internodes_out, Outcome::internodes);
    const double slack = std::max({spacing.x, spacing.y, spacing.z});  // as `shvr evaluate`
    const TraceComparison compared = compare(document.trace, scene.trace(), slack);
    put(values, Outcome::segments_found, double(compared.segments_found));
    put(values, Outcome::segments_total, double(compared.segments_total));
    put(values, Outcome::topological_errors, double(compared.topological_errors()));
    put(values, Outcome::centreline_rms, compared.centreline_rms);
    put(values, Outcome::centreline_most, compared.centreline_most);
}

}  // namespace shvr

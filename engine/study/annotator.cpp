#include "engine/study/annotator.h"

#include <limits>

#include "engine/base/error.h"
#include "engine/study/score.h"
#include "engine/study/session.h"

namespace shvr {

namespace {

/// Fixed before conditions were compared: CALIBRATION.md.
constexpr StudySkill SKILLS[STUDY_ANNOTATORS] = {
    {0.7, 1.7, 1.0, 0.98}, {1.1, 0.6, 1.0, 1.10}, {0.9, 1.1, 0.8, 1.06}, {0.8, 0.85, 0.8, 0.98}, {0.6, 1.2, 0.5, 0.94},
    {0.8, 1.7, 0.6, 1.00}, {1.2, 0.6, 1.2, 1.10}, {0.7, 1.0, 2.0, 0.94}, {0.9, 1.3, 1.0, 0.98},  {1.5, 0.7, 1.5, 1.20},
};

constexpr MistakeRate RATES[MISTAKES] = {
    {Mistake::stops_early, "stops_early", 0.03},      {Mistake::receptacle, "receptacle", 0.06},
    {Mistake::leaves_gaps, "leaves_gaps", 0.05},      {Mistake::adaxial_unpainted, "adaxial_unpainted", 0.02},
    {Mistake::wrong_bundle, "wrong_bundle", 0.02},    {Mistake::joins_bundles, "joins_bundles", 0.012},
    {Mistake::joins_distant, "joins_distant", 0.012}, {Mistake::joins_within, "joins_within", 0.012},
};

}  // namespace

StudySkill skill_of(uint32_t annotator)
{
    SHVR_CHECK(annotator >= 1 && annotator <= STUDY_ANNOTATORS, annotator);
    return SKILLS[annotator - 1];
}

HandTraits traits_of(const StudySkill& skill, const HandTraits& base)
{
    HandTraits traits = base;
    traits.wander_m *= skill.unsteadiness;
    traits.sway_m *= skill.unsteadiness;
    traits.lateral_m *= skill.unsteadiness;
    traits.depth_m *= skill.unsteadiness;
    return traits;
}

std::span<const MistakeRate> mistake_rates()
{
    return RATES;
}

StudyAnnotation annotate(const StudyScene& scene, const StudyCondition& condition, uint32_t annotator, uint32_t seed,
                         const HandTraits& base, uint32_t attempt)
{
    StudyAnnotation made{.row = {.condition = condition, .annotator = annotator, .seed = seed, .values = {}}};
    made.row.values.fill(std::numeric_limits<double>::quiet_NaN());
    const StudySkill skill = skill_of(annotator);
    const StudySessionInput input{scene, condition, skill, traits_of(skill, base),
                                  seed + 1000 * annotator + 100'000 * attempt};
    const std::unique_ptr<StudySession> session =
        condition.task == StudyTask::trace ? make_tracing_session(input) : make_painting_session(input);
    session->run();
    made.mistakes = session->mistakes();
    made.views_changed = session->views_changed();
    made.segments_unseen = session->segments_unseen();
    const Document& document = session->desk().document();
    put_scores(scene, document, made.row);
    session->desk().put_outcomes(made.row);
    if (condition.task == StudyTask::trace) {
        const double minutes = made.row[Outcome::seconds] / 60.0;
        made.row.values[size_t(Outcome::segments_per_minute)] = made.row[Outcome::segments_found] / minutes;
    }
    made.trace = document.trace;
    made.mask = document.mask;
    return made;
}

}  // namespace shvr

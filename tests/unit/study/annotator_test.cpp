// Simulated annotators: guidance keeps them on the axis, their mistakes happen at the stated rates, their clock runs,
// and equal seeds give equal rows.

#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "engine/study/annotator.h"
#include "engine/study/desk.h"
#include "tests/support/slow.h"

using namespace shvr;
using shvr::test::is_slow;
using shvr::test::repeats;

namespace {

const StudyScene& a_section()
{
    static const StudyScene scene({.side = 80, .seed = 1, .noise = 10.0});
    return scene;
}

StudyAnnotation traced(StudyTouch touch, uint32_t annotator = 2, uint32_t seed = 1)
{
    return annotate(a_section(), {.task = StudyTask::trace, .touch = touch}, annotator, seed);
}

}  // namespace

TEST_CASE("object following keeps a traced centre line on the axis, where a free hand strays from it")
{
    const StudyAnnotation guided = traced(StudyTouch::object), free = traced(StudyTouch::none);
    CHECK(guided.row[Outcome::node_score] > free.row[Outcome::node_score] + 0.1);
    CHECK(guided.row[Outcome::contact] > 0.5);
    CHECK(free.row[Outcome::contact] == 0.0);
    CHECK(guided.row[Outcome::segments_found] >= 10.0);
    CHECK(guided.row[Outcome::seconds] <= MAX_STUDY_S);
    CHECK(std::isnan(guided.row[Outcome::dice_partial]));
}

TEST_CASE("equal seeds give equal rows, other seeds other rows")
{
    const auto bits = [](const StudyAnnotation& annotation) { return csv_of(std::span(&annotation.row, 1)); };
    const std::string first = bits(traced(StudyTouch::none));
    CHECK(first == bits(traced(StudyTouch::none)));
    CHECK(first != bits(traced(StudyTouch::none, 2, 5)));
    CHECK(first != bits(traced(StudyTouch::none, 3, 1)));
}

TEST_CASE("mistakes happen at their stated rates, and half of them are noticed and undone")
{
    MistakeTally sum;
    double expected = 0.0, spread = 0.0, made = 0.0, undone = 0.0;
    for (uint32_t seed = 1; seed <= uint32_t(repeats(8, 60)); ++seed)
        for (const StudyTask task : {StudyTask::trace, StudyTask::paint}) {
            const uint32_t annotator = 1 + seed % STUDY_ANNOTATORS;
            const MistakeTally tally =
                annotate(a_section(), {.task = task, .touch = StudyTouch::none}, annotator, seed).mistakes;
            for (const MistakeRate& rate : mistake_rates()) {
                const auto i = size_t(rate.mistake);
                const double p = rate.rate * skill_of(annotator).carelessness;
                expected += p * tally.chances[i];
                spread += p * (1.0 - p) * tally.chances[i];
                made += tally.made[i];
                undone += tally.undone[i];
                sum.chances[i] += tally.chances[i];
                sum.made[i] += tally.made[i];
            }
        }
    CHECK(std::abs(made - expected) < 4.0 * std::sqrt(spread));
    CHECK(undone > 0.0);
    for (const MistakeRate& rate : mistake_rates()) {
        CAPTURE(std::string(rate.name));
        CHECK(sum.chances[size_t(rate.mistake)] >= 30);
        if (is_slow()) CHECK(sum.made[size_t(rate.mistake)] > 0);
    }
}

TEST_CASE("pauses and edits cost what they state, ticks a millisecond each")
{
    StudyDesk desk(a_section(), {.touch = StudyTouch::none}, {}, 1);
    const double begin = desk.seconds();
    desk.spend(2.5);
    for (int i = 0; i < 100; ++i) desk.tick(glm::dvec3(40.0), 0.0);
    CHECK(desk.seconds() == doctest::Approx(begin + 2.6));
    CHECK_FALSE(desk.is_over());
    desk.spend(MAX_STUDY_S);
    CHECK(desk.is_over());
    StudyRow row{.condition = {}, .values = {}};
    desk.put_outcomes(row);
    CHECK(row[Outcome::seconds] == MAX_STUDY_S);
}

TEST_CASE("edits of a study go through the work's history and can be undone")
{
    StudyDesk desk(a_section(), {.touch = StudyTouch::none}, {}, 1);
    CHECK_FALSE(desk.edit_trace(SelectOp{.near = glm::dvec3(40.0), .number = {}}));
    CHECK(desk.edit_trace(NodeOp{.at = glm::dvec3(40.0), .radius_voxels = 2.0, .group = {}}));
    CHECK(desk.edit_trace(NodeOp{.at = glm::dvec3(44.0), .radius_voxels = 2.0, .group = {}}));
    CHECK(desk.document().trace.internodes().size() == 1);
    desk.undo();
    CHECK(desk.document().trace.internodes().size() == 0);
    CHECK(desk.document().trace.nodes().size() == 1);
    const glm::dvec3 vein = a_section().trace().node(5).position;
    const int64_t painted = desk.paint({vein, vein + glm::dvec3(2.0, 0.0, 0.0)}, STUDY_THRESHOLD);
    CHECK(painted > 0);
    CHECK(desk.document().mask.voxels_by_group()[1] == painted);
    desk.undo();
    CHECK(desk.document().mask.voxels_by_group()[1] == 0);
    CHECK(desk.undos() == 2);
}

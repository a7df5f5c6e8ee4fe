// What a study annotates: what is felt and painted there equals what the program's own code finds, and what is hidden
// is not seen.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include "engine/live/relevance_host.h"
#include "engine/study/plan.h"
#include "engine/study/sight.h"

using namespace shvr;

namespace {

const StudyScene& a_scene()
{
    static const StudyScene scene({.side = 80, .seed = 3, .noise = 25.0});  // sides that are no multiple of 32
    return scene;
}

}  // namespace

TEST_CASE("relevance in a study has the bits that the program's host code computes, at borders, too")
{
    const StudyScene& scene = a_scene();
    const auto patch = std::make_unique<RelevancePatch>();
    for (const glm::dvec3& at : {glm::dvec3(40.0), glm::dvec3(0.0), glm::dvec3(80.0), glm::dvec3(33.3, 70.1, 12.7)}) {
        const RegionWish wish{.point = at, .radius = 5.0, .velocity = glm::dvec3(30.0, 0.0, -10.0), .latency_s = 0.024};
        scene.put_relevance(wish, *patch);
        const RelevancePlace place = relevance_place(scene.volume(), wish);
        const RelevanceBits bits = relevance_on_host(scene.volume(), 0, place.box, STUDY_THRESHOLD);
        CHECK(patch->is_well_formed());
        CHECK(glm::ivec3(place.box.lower) == patch->origin);
        REQUIRE(patch->word_count() == bits.words.size());
        CHECK(std::equal(bits.words.begin(), bits.words.end(), patch->words.begin()));
    }
}

TEST_CASE("a fill paints the voxels of the ball at or above the threshold, a flood those connected to its middle")
{
    const StudyScene& scene = a_scene();
    const glm::dvec3 at = scene.trace().node(10).position;
    const auto selected_by = [&](Brush brush) {
        return scene.select({.brush = brush, .threshold = STUDY_THRESHOLD, .radius_voxels = 6.0, .path = {at}});
    };
    const VoxelSelection filled = selected_by(Brush::fill), flooded = selected_by(Brush::flood);
    int64_t count = 0;
    for (int64_t z = 0; z < 80; ++z)
        for (int64_t y = 0; y < 80; ++y)
            for (int64_t x = 0; x < 80; ++x) {
                const Size3 voxel(x, y, z);
                const bool is_told =
                    glm::distance(glm::dvec3(voxel) + 0.5, at) <= 6.0 && scene.intensity(voxel) >= STUDY_THRESHOLD;
                count += is_told;
                if (filled.contains(voxel) != is_told) FAIL_CHECK("voxel ", x, " ", y, " ", z);
                if (flooded.contains(voxel) && !is_told) FAIL_CHECK("flooded ", x, " ", y, " ", z);
            }
    CHECK(filled.count() == count);
    CHECK(flooded.count() > 0);
    CHECK(flooded.count() < count);  // noise apart from the vein
}

TEST_CASE("an eye sees what nothing hides, and not what lies behind another bundle")
{
    const StudyScene scene({.side = 128, .seed = 1, .noise = 10.0});
    const StudySight sight(scene, {});
    const StudyView& front = study_views()[0];
    size_t behind = 0, behind_and_shown = 0, clear = 0, clear_and_hidden = 0;
    for (const auto& [number, node] : scene.trace().nodes()) {
        double least = 1e9;  // distance of another bundle's axis, in front of the node, from the line of sight
        for (const auto& [name, internode] : scene.trace().internodes())
            for (double t = 0.0; t <= 1.0; t += 0.05) {
                const glm::dvec3 at =
                    glm::mix(scene.trace().node(internode.a).position, scene.trace().node(internode.b).position, t);
                const glm::dvec3 away = at - node.position;
                const double depth = glm::dot(away, front.to_eye);
                if (depth > 8.0) least = std::min(least, glm::length(away - depth * front.to_eye));
            }
        const bool is_shown = sight.shows(front, node.position, scene.vein_radius());
        behind += least < 0.5;
        behind_and_shown += least < 0.5 && is_shown;
        const bool has_no_separate = node.position.z > 0.25 * 128.0;  // those lie lower, or stand next to florets
        clear += least > 8.0 && has_no_separate;
        clear_and_hidden += least > 8.0 && has_no_separate && !is_shown;
    }
    CHECK(behind >= 3);
    CHECK(behind_and_shown == 0);
    CHECK(clear >= 10);
    CHECK(clear_and_hidden <= clear / 4);
}

TEST_CASE("the best view shows the most, and the present one stays if it is as good")
{
    const StudyScene& scene = a_scene();
    const StudySight sight(scene, {});
    std::vector<glm::dvec3> all;
    for (const auto& [number, node] : scene.trace().nodes()) all.push_back(node.position);
    const size_t best = sight.best_view(0, all, scene.vein_radius());
    for (const StudyView& view : study_views())
        CHECK(sight.visible_share(study_views()[best], all, scene.vein_radius()) >=
              sight.visible_share(view, all, scene.vein_radius()));
    CHECK(sight.best_view(best, all, scene.vein_radius()) == best);
}

TEST_CASE("a view has unit vectors at right angles, and an eye errs more along its line of sight than across")
{
    const StudyScene& scene = a_scene();
    const HandTraits traits;
    const StudySight sight(scene, traits);
    StudyRandom random(4);
    for (const StudyView& view : study_views()) {
        CHECK(glm::length(view.to_eye) == doctest::Approx(1.0));
        CHECK(glm::length(view.right) == doctest::Approx(1.0));
        CHECK(glm::dot(view.to_eye, view.right) == doctest::Approx(0.0));
        double deep = 0.0, across = 0.0;
        constexpr int COUNT = 4000;
        for (int i = 0; i < COUNT; ++i) {
            const glm::dvec3 error = sight.error_of_glance(view, random) / scene.voxels_per_metre();
            deep += std::pow(glm::dot(error, view.to_eye), 2) / COUNT;
            across += std::pow(glm::dot(error, view.right), 2) / COUNT;
        }
        CHECK(std::sqrt(deep) == doctest::Approx(traits.depth_m).epsilon(0.05));
        CHECK(std::sqrt(across) == doctest::Approx(traits.lateral_m).epsilon(0.05));
    }
}

TEST_CASE("a plan holds every segment once, begins at an end of an adaxial vein, and goes on where it has been")
{
    const StudyScene& scene = a_scene();
    StudyRandom random(2);
    const std::vector<PlannedSegment> plan = plan_segments(scene, random);
    REQUIRE(plan.size() == 26);
    CHECK(plan.front().is_adaxial);
    CHECK(scene.trace().internodes_of(plan.front().nodes.front()).size() == 1);
    std::set<size_t> segments;
    std::set<uint32_t> reached(plan.front().nodes.begin(), plan.front().nodes.end());
    for (const PlannedSegment& planned : plan) {
        segments.insert(planned.segment);
        CHECK(reached.contains(planned.nodes.front()));
        reached.insert(planned.nodes.begin(), planned.nodes.end());
    }
    CHECK(segments.size() == 26);
}

TEST_CASE("points along a course are equally far apart and include its ends")
{
    const std::vector<glm::dvec3> course = {{0.0, 0.0, 0.0}, {3.0, 0.0, 0.0}, {3.0, 7.0, 0.0}};
    const std::vector<glm::dvec3> points = points_along(course, 2.1);
    REQUIRE(points.size() == 6);
    CHECK(points.front() == course.front());
    CHECK(points.back() == course.back());
    CHECK(points[1] == glm::dvec3(2.0, 0.0, 0.0));
    CHECK(glm::distance(points[2], glm::dvec3(3.0, 1.0, 0.0)) < 1e-12);
    CHECK(points_along(course, 1e9).size() == 2);
}

TEST_CASE("separate bundles are found with their courses, in the full mask and outside the partial one")
{
    const StudyScene& scene = a_scene();
    CHECK(scene.separate_bundles().size() >= 3);
    for (const SeparateBundle& bundle : scene.separate_bundles()) {
        CHECK(bundle.course.size() >= 2);
        for (const glm::dvec3& at : bundle.course) CHECK(scene.full_mask().at(Size3(glm::floor(at))) != 0);
    }
}

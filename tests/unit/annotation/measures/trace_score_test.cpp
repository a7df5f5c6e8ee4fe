#include "engine/annotation/measures/trace_score.h"

#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "engine/annotation/measures/trace_course.h"
#include "engine/annotation/trace/trace_forms.h"
#include "tests/support/traces.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Draws chains of nodes between places, as far apart as `step`, all of one radius.
class Drawing : public GrowingTrace {
public:
    explicit Drawing(double radius = 1.0, double step = 2.0) : radius_(radius), step_(step) {}

    uint32_t node(const glm::dvec3& at) { return GrowingTrace::node(at, radius_); }
    /// From a node to a new one at `to`, which it returns, or to `end`.
    uint32_t chain(uint32_t from, const glm::dvec3& to, std::optional<uint32_t> end = {})
    {
        const glm::dvec3 start = trace.node(from).position;
        const int parts = std::max(1, int(std::ceil(glm::length(to - start) / step_)));
        uint32_t last = from;
        for (int i = 1; i <= parts; ++i) {
            const double t = double(i) / parts;
            const uint32_t next = i == parts && end ? *end : node((1.0 - t) * start + t * to);
            link(last, next);
            last = next;
        }
        return last;
    }
    void chain_between(uint32_t from, uint32_t to) { chain(from, trace.node(to).position, to); }

private:
    double radius_, step_;
};

/// A tree of five segments with two branches; `draw` may draw something different.
struct Tree {
    uint32_t root, first, second, left, right, top;
};
Tree draw_tree(Drawing& drawing, const glm::dvec3& moved = glm::dvec3(0.0))
{
    Tree tree;
    tree.root = drawing.node(glm::dvec3(0, 0, 0) + moved);
    tree.first = drawing.chain(tree.root, glm::dvec3(0, 0, 30) + moved);
    tree.left = drawing.chain(tree.first, glm::dvec3(-30, 0, 50) + moved);
    tree.second = drawing.chain(tree.first, glm::dvec3(20, 0, 60) + moved);
    tree.right = drawing.chain(tree.second, glm::dvec3(50, 0, 80) + moved);
    tree.top = drawing.chain(tree.second, glm::dvec3(20, 20, 90) + moved);
    return tree;
}

TraceGraph true_tree()
{
    Drawing drawing;
    draw_tree(drawing);
    return drawing.trace;
}

void check_counts(const TraceComparison& found, int64_t segments, int64_t wrong, int64_t doubled, int64_t gaps,
                  int64_t breaks = 0, int64_t spurs = 0, int64_t superfluous = 0)
{
    CHECK(found.segments_found == segments);
    CHECK(found.wrong == wrong);
    CHECK(found.doubled == doubled);
    CHECK(found.gaps == gaps);
    CHECK(found.breaks == breaks);
    CHECK(found.spurs == spurs);
    CHECK(found.superfluous == superfluous);
    CHECK(found.topological_errors() == wrong + doubled + gaps + breaks + spurs + superfluous);
}

void paint_box(Mask& mask, const Size3& lower, const Size3& upper, uint8_t group)
{
    for (int64_t z = lower.z; z < upper.z; ++z)
        for (int64_t y = lower.y; y < upper.y; ++y) {
            const auto at = uint16_t(32 * (y + 32 * z));
            mask.apply({0, {{uint16_t(at + lower.x), uint16_t(at + upper.x - 1), 0, group}}}, Direction::forwards);
        }
}

}  // namespace

TEST_CASE("Dice of all that is painted and of each group")
{
    Mask truth({20, 20, 20}), mask({20, 20, 20});
    CHECK(!dice_of(truth, mask).painted);
    paint_box(truth, {0, 0, 0}, {4, 4, 4}, 1);   // 64
    paint_box(truth, {8, 0, 0}, {12, 4, 4}, 2);  // 64
    paint_box(mask, {2, 0, 0}, {4, 4, 4}, 1);    // 32, all of them right
    paint_box(mask, {8, 0, 0}, {12, 4, 4}, 3);   // 64 of another group
    const Dice dice = dice_of(truth, mask);
    CHECK(dice.painted.value() == doctest::Approx(2.0 * 96.0 / (128.0 + 96.0)).epsilon(1e-15));
    REQUIRE(dice.by_group.size() == 3);
    CHECK(dice.by_group.at(1) == doctest::Approx(2.0 * 32.0 / (64.0 + 32.0)).epsilon(1e-15));
    CHECK(dice.by_group.at(2) == 0.0);
    CHECK(dice.by_group.at(3) == 0.0);
    CHECK(dice_of(truth, truth).painted == 1.0);
}

TEST_CASE("the share of a ball in the mask, voxel by voxel, at any spacing")
{
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(-3.0, 23.0);
    Mask mask({20, 18, 16});
    paint_box(mask, {2, 3, 4}, {11, 13, 15}, 1);
    for (const glm::dvec3 spacing : {glm::dvec3(1.0), glm::dvec3(0.5, 1.25, 2.0)})
        for (int i = 0; i < 200; ++i) {
            const glm::dvec3 at = glm::dvec3(uniform(random), uniform(random), uniform(random)) * spacing;
            const double radius = 0.5 + std::abs(uniform(random)) / 4.0;
            int64_t all = 0, painted = 0;
            for (int64_t z = -30; z < 50; ++z)
                for (int64_t y = -30; y < 50; ++y)
                    for (int64_t x = -30; x < 50; ++x) {
                        const glm::dvec3 away = (glm::dvec3(x, y, z) + 0.5) * spacing - at;
                        if (glm::dot(away, away) > radius * radius) continue;
                        ++all;
                        const Size3 voxel(x, y, z);
                        painted += glm::all(glm::greaterThanEqual(voxel, Size3(0))) &&
                                   glm::all(glm::lessThan(voxel, mask.size())) && mask.at(voxel) != 0;
                    }
            if (all > 0) CHECK(share_in_mask(mask, spacing, at, radius) == double(painted) / double(all));
        }
    // A ball too small to contain the centre of a voxel: the voxel it lies in counts.
    CHECK(share_in_mask(mask, glm::dvec3(1.0), {2.01, 3.01, 4.01}, 0.1) == 1.0);
    CHECK(share_in_mask(mask, glm::dvec3(1.0), {1.99, 3.01, 4.01}, 0.1) == 0.0);
    CHECK(share_in_mask(mask, glm::dvec3(1.0), {-5, 3.01, 4.01}, 0.0) == 0.0);
    CHECK(contains(error_of([&] {
                       share_in_mask(mask, glm::dvec3(1.0), {0, 0, 0}, 1e9);
                   }),
                   "expected a smaller radius"));
}

TEST_CASE("nodes and internodes are scored by their balls; less than half is out")
{
    Mask truth({20, 20, 20});
    paint_box(truth, {0, 0, 0}, {10, 20, 20}, 5);
    Drawing drawing(2.0);
    // Inside, exactly half (its centre is on the border, so that equally many voxels lie on both sides), and outside.
    const uint32_t in = drawing.node({5, 10, 10}), half = drawing.node({10, 10, 10}), out = drawing.node({16, 10, 10});
    drawing.link(in, half);   // its middle, 7.5, is almost inside: some voxels are not
    drawing.link(half, out);  // 13: outside
    const BallScores nodes = score_nodes(drawing.trace, truth, glm::dvec3(1.0));
    CHECK(nodes.mean.value() == doctest::Approx(0.5).epsilon(1e-15));
    CHECK(nodes.out == 1);
    CHECK(nodes.total == 3);
    const BallScores internodes = score_internodes(drawing.trace, truth, glm::dvec3(1.0));
    CHECK(internodes.mean.value() == doctest::Approx(0.5).epsilon(1e-15));
    CHECK(internodes.out == 1);
    CHECK(internodes.total == 2);
    CHECK(!score_nodes({}, truth, glm::dvec3(1.0)).mean);
}

TEST_CASE("a trace compared with itself has all segments and no error")
{
    const TraceGraph truth = true_tree();
    const TraceComparison found = compare(truth, truth, 0.5);
    CHECK(found.segments_total == 5);
    check_counts(found, 5, 0, 0, 0);
    CHECK(found.centreline_rms.value() < 1e-6);
}

TEST_CASE("other nodes along the same course change nothing")
{
    Drawing fine(1.0, 0.7), coarse(1.0, 100.0);
    draw_tree(fine);
    draw_tree(coarse);
    check_counts(compare(fine.trace, true_tree(), 0.5), 5, 0, 0, 0);
    check_counts(compare(coarse.trace, true_tree(), 0.5), 5, 0, 0, 0);
    check_counts(compare(true_tree(), coarse.trace, 0.5), 5, 0, 0, 0);
}

TEST_CASE("a trace moved sideways is found while balls touch, and its distance is measured")
{
    Drawing near, far;
    draw_tree(near, {0, 1.5, 0});
    draw_tree(far, {0, 4.0, 0});
    const TraceComparison found = compare(near.trace, true_tree(), 0.0);
    check_counts(found, 5, 0, 0, 0);
    // All segments are 1.5 away, except that the one rising along y is nearer.
    CHECK(found.centreline_most.value() == doctest::Approx(1.5).epsilon(1e-9));
    CHECK(found.centreline_rms.value() < 1.5);
    CHECK(found.centreline_rms.value() > 1.4);
    check_counts(compare(far.trace, true_tree(), 0.0), 0, 5, 0, 0);
    check_counts(compare(far.trace, true_tree(), 2.5), 5, 0, 0, 0);
}

TEST_CASE("the centre-line distance of a parallel line is that distance, and of a slanted one its root mean square")
{
    Drawing truth, parallel, slanted;
    truth.chain(truth.node({0, 0, 0}), {100, 0, 0});
    parallel.chain(parallel.node({10, 3, 4}), {90, 3, 4});
    CHECK(compare(parallel.trace, truth.trace, 10.0).centreline_rms.value() == doctest::Approx(5.0).epsilon(1e-12));
    slanted.chain(slanted.node({0, 0, 0}), {100, 6, 0});
    const TraceComparison found = compare(slanted.trace, truth.trace, 10.0);
    CHECK(found.centreline_rms.value() == doctest::Approx(6.0 / std::sqrt(3.0)).epsilon(1e-12));
    CHECK(!compare({}, truth.trace, 1.0).centreline_rms);
    CHECK(!compare(truth.trace, {}, 1.0).centreline_rms);
}

TEST_CASE("a segment that is missing or traced in part is not found, and no error")
{
    Drawing drawing;
    const uint32_t root = drawing.node({0, 0, 0});
    const uint32_t first = drawing.chain(root, {0, 0, 30});
    drawing.chain(first, {20, 0, 60});             // a segment without its branch's other arms
    drawing.chain(first, glm::dvec3(-15, 0, 40));  // half of an arm
    check_counts(compare(drawing.trace, true_tree(), 0.5), 2, 0, 0, 0);
}

TEST_CASE("a branch that the trace passes without an arm still ends a segment")
{
    Drawing drawing;
    const uint32_t root = drawing.node({0, 0, 0});
    drawing.chain(drawing.chain(root, {0, 0, 30}), {-30, 0, 50});
    check_counts(compare(drawing.trace, true_tree(), 0.5), 2, 0, 0, 0);
}

TEST_CASE("a link between two separate segments is an error")
{
    Drawing drawing;
    const Tree tree = draw_tree(drawing);
    drawing.link(tree.left, tree.right);
    const TraceComparison found = compare(drawing.trace, true_tree(), 0.5);
    check_counts(found, 5, 1, 0, 0);

    Drawing bundles;  // two that run side by side, their balls apart
    const uint32_t a = bundles.node({0, 0, 0}), b = bundles.node({0, 5, 0});
    const uint32_t a_end = bundles.chain(a, {60, 0, 0});
    bundles.chain(b, {60, 5, 0});
    const TraceGraph truth = bundles.trace;
    CHECK(compare(truth, truth, 0.5).segments_found == 2);
    bundles.link(a_end - 15, *bundles.trace.nearest_node({30, 5, 0}));  // a rung
    const TraceComparison rung = compare(bundles.trace, truth, 0.5);
    CHECK(rung.topological_errors() == 1);
    CHECK(rung.wrong == 1);
}

TEST_CASE("a trace that goes over to another bundle half way is an error and finds neither")
{
    Drawing bundles, crossing;
    bundles.chain(bundles.node({0, 0, 0}), {60, 0, 0});
    bundles.chain(bundles.node({0, 5, 0}), {60, 5, 0});
    crossing.chain(crossing.chain(crossing.node({0, 0, 0}), {28, 0, 0}), {60, 5, 0});
    const TraceComparison found = compare(crossing.trace, bundles.trace, 0.5);
    check_counts(found, 0, 1, 0, 0);
}

TEST_CASE("a chord within a bundle is an error")
{
    Drawing truth, drawing;
    truth.chain(truth.node({0, 0, 0}), {60, 0, 0});
    drawing.chain(drawing.node({0, 0, 0}), {60, 0, 0});
    drawing.link(*drawing.trace.nearest_node({20, 0, 0}), *drawing.trace.nearest_node({40, 0, 0}));
    const TraceComparison found = compare(drawing.trace, truth.trace, 0.5);
    check_counts(found, 1, 0, 1, 0);
}

TEST_CASE("a bundle traced twice is an error")
{
    Drawing truth, drawing;
    truth.chain(truth.node({0, 0, 0}), {60, 0, 0});
    drawing.chain(drawing.node({0, 0, 0}), {60, 0, 0});
    drawing.chain(drawing.node({10, 0.5, 0}), {50, 0.5, 0});
    check_counts(compare(drawing.trace, truth.trace, 0.5), 1, 0, 1, 0);
}

TEST_CASE("an arm that is not joined to its branch is an error, and not found")
{
    Drawing drawing;
    const uint32_t root = drawing.node({0, 0, 0});
    const uint32_t first = drawing.chain(root, {0, 0, 30});
    drawing.chain(first, {-30, 0, 50});
    const uint32_t loose = drawing.node({0.6, 0, 30.9});
    const uint32_t second = drawing.chain(loose, {20, 0, 60});
    drawing.chain(second, {50, 0, 80});
    drawing.chain(second, {20, 20, 90});
    check_counts(compare(drawing.trace, true_tree(), 0.5), 4, 0, 0, 1);
}

TEST_CASE("something drawn where the truth has nothing is an error")
{
    Drawing drawing;
    const Tree tree = draw_tree(drawing);
    drawing.chain(tree.left, {-60, 0, 50});
    drawing.chain(drawing.node({100, 100, 100}), {120, 100, 100});
    check_counts(compare(drawing.trace, true_tree(), 0.5), 5, 2, 0, 0);
}

TEST_CASE("loops of the truth are found when they are closed")
{
    const auto ring = [](bool closed, bool with_stalk) {
        Drawing drawing;
        const uint32_t first = drawing.node({20, 0, 0});
        uint32_t last = first;
        for (int i = 1; i < 60; ++i) {
            const double angle = 2.0 * 3.14159265358979 * i / 60;
            const uint32_t next = drawing.node({20 * std::cos(angle), 20 * std::sin(angle), 0});
            drawing.link(last, next);
            last = next;
        }
        if (closed) drawing.link(last, first);
        if (with_stalk) drawing.chain(first, {50, 0, 0});
        return drawing.trace;
    };
    check_counts(compare(ring(true, false), ring(true, false), 0.1), 1, 0, 0, 0);
    check_counts(compare(ring(false, false), ring(true, false), 0.1), 0, 0, 0, 0, 1);
    check_counts(compare(ring(true, true), ring(true, true), 0.1), 2, 0, 0, 0);
    CHECK(compare(ring(true, false), ring(false, false), 0.0).segments_found == 1);
}

TEST_CASE("the way to a trace is that of a search through all internodes")
{
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(0.0, 100.0);
    Drawing drawing;
    for (int i = 0; i < 150; ++i) drawing.node({uniform(random), uniform(random), uniform(random)});
    for (int i = 0; i < 120; ++i) {
        const uint32_t a = uint32_t(random() % 150), b = uint32_t(random() % 150);
        if (a != b && !drawing.trace.internode_between(a, b)) drawing.link(a, b);
    }
    const TraceCourse course(drawing.trace);
    for (int i = 0; i < 300; ++i) {
        const glm::dvec3 at(uniform(random), uniform(random), uniform(random));
        double least = 1e300;
        for (const auto& [number, internode] : drawing.trace.internodes())
            least = std::min(least, distance_to(drawing.trace, internode, at));
        CHECK(course.nearest_to(at)->distance == doctest::Approx(least).epsilon(1e-12));
    }
}

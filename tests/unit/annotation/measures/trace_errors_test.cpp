// Closed cases of the errors of a trace: breaks, unjoined ends, spurs and superfluous segments, one at a time and
// several at once. trace_score_test.cpp holds those that leave the truth or double it.

#include <cmath>

#include <doctest/doctest.h>

#include "engine/annotation/measures/trace_score.h"
#include "tests/support/traces.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr double SLACK = 0.5;

class Drawing : public GrowingTrace {
public:
    /// Nodes 2 apart along a straight line, from a node; returns the last, which is at `to`.
    uint32_t chain(uint32_t from, const glm::dvec3& to)
    {
        const glm::dvec3 start = trace.node(from).position;
        const int parts = std::max(1, int(std::ceil(glm::length(to - start) / 2.0)));
        for (int i = 1; i <= parts; ++i) {
            const uint32_t next = node(start + (to - start) * (double(i) / parts), 1.0);
            link(from, next);
            from = next;
        }
        return from;
    }
    uint32_t line(const glm::dvec3& from, const glm::dvec3& to) { return chain(node(from, 1.0), to); }
    uint32_t at(const glm::dvec3& place) const { return *trace.nearest_node(place); }
};

Drawing tube()
{
    Drawing drawing;
    drawing.line({0, 0, 0}, {60, 0, 0});
    return drawing;
}

/// A trunk along x with an arm along y from its middle.
Drawing branched()
{
    Drawing drawing = tube();
    drawing.chain(drawing.at({30, 0, 0}), {30, 30, 0});
    return drawing;
}

struct Errors {
    int64_t breaks = 0, gaps = 0, spurs = 0, superfluous = 0, doubled = 0;
    bool operator==(const Errors&) const = default;
};
doctest::String toString(const Errors& errors)
{
    return ("breaks " + std::to_string(errors.breaks) + ", gaps " + std::to_string(errors.gaps) + ", spurs " +
            std::to_string(errors.spurs) + ", superfluous " + std::to_string(errors.superfluous) + ", doubled " +
            std::to_string(errors.doubled))
        .c_str();
}

Errors errors_of(const Drawing& drawing, const Drawing& truth)
{
    const TraceComparison found = compare(drawing.trace, truth.trace, SLACK);
    CHECK(found.wrong == 0);
    const Errors errors{found.breaks, found.gaps, found.spurs, found.superfluous, found.doubled};
    CHECK(found.topological_errors() ==
          errors.breaks + errors.gaps + errors.spurs + errors.superfluous + errors.doubled);
    return errors;
}

}  // namespace

// Kind (Scores): a break in the middle of a tube
TEST_CASE("a tube that is broken once or twice has that many breaks, however wide they are")
{
    for (const double width : {2.0, 4.0, 20.0}) {
        CAPTURE(width);
        Drawing once, twice;
        once.line({0, 0, 0}, {30 - width / 2, 0, 0});
        once.line({30 + width / 2, 0, 0}, {60, 0, 0});
        CHECK(errors_of(once, tube()) == Errors{.breaks = 1});
        twice.line({0, 0, 0}, {15 - width / 2, 0, 0});
        twice.line({15 + width / 2, 0, 0}, {45 - width / 2, 0, 0});
        twice.line({60, 0, 0}, {45 + width / 2, 0, 0});
        CHECK(errors_of(twice, tube()) == Errors{.breaks = 2});
    }
    Drawing half;
    half.line({0, 0, 0}, {30, 0, 0});
    CHECK(errors_of(half, tube()) == Errors{});
}

TEST_CASE("a break in an arm, and one in a tube whose ends are not traced")
{
    Drawing arm = tube(), short_tube;
    arm.chain(arm.at({30, 0, 0}), {30, 10, 0});
    arm.line({30, 16, 0}, {30, 30, 0});
    CHECK(errors_of(arm, branched()) == Errors{.breaks = 1});
    short_tube.line({10, 0, 0}, {28, 0, 0});
    short_tube.line({32, 0, 0}, {50, 0, 0});
    CHECK(errors_of(short_tube, tube()) == Errors{.breaks = 1});
}

// Kind (Scores): an arm that is not joined to its trunk
TEST_CASE("an arm that stops before its branch is an unjoined end, at any distance")
{
    for (const double distance : {1.0, 2.0, 4.0, 15.0}) {
        CAPTURE(distance);
        Drawing drawing = tube();
        drawing.line({30, 30, 0}, {30, distance, 0});
        CHECK(errors_of(drawing, branched()) == Errors{.gaps = 1});
    }
    Drawing alone, partial = tube();
    alone.line({30, 30, 0}, {30, 10, 0});  // nothing of the branch is traced
    CHECK(errors_of(alone, branched()) == Errors{});
    partial.chain(partial.at({30, 0, 0}), {30, 14, 0});
    CHECK(errors_of(partial, branched()) == Errors{});
}

TEST_CASE("an arm whose trunk passes without a node at the branch is an unjoined end")
{
    Drawing drawing;
    drawing.link(drawing.node({0, 0, 0}, 1.0), drawing.node({60, 0, 0}, 1.0));
    drawing.line({30, 30, 0}, {30, 0, 0});
    CHECK(errors_of(drawing, branched()) == Errors{.gaps = 1});
}

// Kind (Scores): spurs shorter than two radii
TEST_CASE("short side branches are spurs, wherever they are")
{
    for (const double length : {0.5, 1.5, 2.4}) {
        CAPTURE(length);
        Drawing one = tube(), two = tube(), at_branch = branched(), forked;
        one.chain(one.at({20, 0, 0}), {20, length, 0});
        CHECK(errors_of(one, tube()) == Errors{.spurs = 1});
        two.chain(two.at({20, 0, 0}), {20, length, 0});
        two.chain(two.at({40, 0, 0}), {40, 0, -length});
        CHECK(errors_of(two, tube()) == Errors{.spurs = 2});
        at_branch.chain(at_branch.at({30, 0, 0}), {30, 0, length});
        CHECK(errors_of(at_branch, branched()) == Errors{.spurs = 1});
        const uint32_t fork = forked.line({0, 0, 0}, {59, 0, 0});
        forked.chain(fork, {60, 0, 0});
        forked.chain(fork, {59.5, length, 0});
        CHECK(errors_of(forked, tube()) == Errors{.spurs = 1});
    }
}

TEST_CASE("a trace that is a little longer or shorter than the truth has no spur")
{
    for (const double beyond : {-4.0, -1.0, 1.0, 1.5}) {
        CAPTURE(beyond);
        Drawing drawing;
        drawing.line({-beyond, 0, 0}, {60 + beyond, 0, 0});
        CHECK(errors_of(drawing, tube()) == Errors{});
    }
}

// Kind (Scores): superfluous segments
TEST_CASE("small loops, rungs and loose pieces are superfluous, and short cuts double it")
{
    Drawing short_cut = tube(), loop = tube(), beside = tube(), rung;
    short_cut.link(short_cut.at({20, 0, 0}), short_cut.at({24, 0, 0}));
    CHECK(errors_of(short_cut, tube()) == Errors{.doubled = 1});
    const uint32_t first = loop.chain(loop.at({20, 0, 0}), {20, 1.5, 0});
    loop.link(loop.chain(first, {20, 1.5, 1}), loop.at({20, 0, 0}));
    CHECK(errors_of(loop, tube()) == Errors{.superfluous = 1});
    beside.line({20, 1, 0}, {22, 1, 0});
    CHECK(errors_of(beside, tube()) == Errors{.superfluous = 1});
    // Two bundles whose balls touch, and a rung between them.
    rung.line({0, 0, 0}, {60, 0, 0});
    rung.line({0, 2.2, 0}, {60, 2.2, 0});
    const Drawing bundles = rung;
    CHECK(errors_of(bundles, bundles) == Errors{});
    rung.link(rung.at({30, 0, 0}), rung.at({30, 2.2, 0}));
    CHECK(errors_of(rung, bundles) == Errors{.superfluous = 1});
}

TEST_CASE("errors of several kinds in one trace are each counted")
{
    Drawing drawing;
    drawing.line({0, 0, 0}, {10, 0, 0});
    const uint32_t end = drawing.line({14, 0, 0}, {60, 0, 0});  // a break
    drawing.line({30, 30, 0}, {30, 5, 0});                      // an unjoined end
    drawing.chain(drawing.at({50, 0, 0}), {50, 1.5, 0});        // a spur
    drawing.link(end, end - 2);                                 // a short cut
    CHECK(errors_of(drawing, branched()) == Errors{.breaks = 1, .gaps = 1, .spurs = 1, .doubled = 1});
}

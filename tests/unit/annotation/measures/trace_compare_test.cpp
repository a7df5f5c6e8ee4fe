// The rules of a comparison of traces, case by case: which node matches which branch or end, what counts as near, which
// paths exist, and what is an error. trace_score_test.cpp compares whole trees.

#include <cmath>
#include <vector>

#include <doctest/doctest.h>

#include "engine/annotation/measures/trace_score.h"
#include "tests/support/traces.h"

using namespace shvr;
using namespace shvr::test;

namespace {

using Places = std::vector<glm::dvec3>;

class Drawing : public GrowingTrace {
public:
    uint32_t node(const glm::dvec3& at, double radius = 1.0) { return GrowingTrace::node(at, radius); }
    /// Nodes at these places, one after the other, and from `from`; returns the last.
    uint32_t line(const Places& places, double radius = 1.0, std::optional<uint32_t> from = {})
    {
        for (const glm::dvec3& place : places) {
            const uint32_t next = node(place, radius);
            if (from) link(*from, next);
            from = next;
        }
        return from.value();
    }
};

TraceGraph line_of(const Places& places, double radius = 1.0)
{
    Drawing drawing;
    drawing.line(places, radius);
    return drawing.trace;
}

/// Along x.
Places steps(double from, double to, double step)
{
    Places places;
    const int parts = int(std::round(std::abs(to - from) / step));
    for (int i = 0; i <= parts; ++i) places.emplace_back(from + (to - from) * i / parts, 0.0, 0.0);
    return places;
}

Drawing ring(int first, int last, int parts)
{
    Drawing drawing;
    Places places;
    for (int i = first; i <= last; ++i) {
        const double angle = 2.0 * 3.14159265358979 * i / parts;
        places.emplace_back(20.0 * std::cos(angle), 20.0 * std::sin(angle), 0.0);
    }
    drawing.line(places);
    return drawing;
}

}  // namespace

TEST_CASE("a branch stands for a branch, though another node is nearer")
{
    Drawing truth, drawing;
    const uint32_t key = truth.node({0, 0, 0});
    for (const glm::dvec3 end : {glm::dvec3(30, 0, 0), glm::dvec3(-30, 0, 0), glm::dvec3(0, 30, 0)})
        truth.line({0.5 * end, end}, 1.0, key);
    const uint32_t branch = drawing.node({0, 0.8, 0});
    drawing.line({{0.3, 0, 0}, {15, 0, 0}, {30, 0, 0}}, 1.0, branch);
    drawing.line({{-15, 0, 0}, {-30, 0, 0}}, 1.0, branch);
    drawing.line({{0, 15, 0}, {0, 30, 0}}, 1.0, branch);
    // A side branch that just begins at the branch is no gap: it is the branch itself.
    drawing.line({{0, 0.8, 1.2}}, 1.0, branch);
    const TraceComparison found = compare(drawing.trace, truth.trace, 0.0);
    CHECK(found.segments_found == 3);
    CHECK(found.gaps == 0);
    CHECK(found.spurs == 1);
}

TEST_CASE("of nodes of one kind the nearest stands for an end, whatever its number")
{
    for (const bool stray_first : {true, false}) {
        CAPTURE(stray_first);
        Drawing drawing;
        const auto draw_stray = [&] { drawing.line({{0, 1.8, 0}, {0, 12, 0}}); };
        if (stray_first) draw_stray();
        drawing.line({{0.1, 0, 0}, {15, 0, 0}, {30, 0, 0}});
        if (!stray_first) draw_stray();
        CHECK(compare(drawing.trace, line_of({{0, 0, 0}, {30, 0, 0}}), 0.0).segments_found == 1);
    }
}

TEST_CASE("a node stands for one end alone, the nearest")
{
    Drawing truth;
    truth.line(steps(-30, 0, 2));
    truth.line(steps(1, 31, 2));
    CHECK(compare(line_of({{-30, 0, 0}, {0.4, 0, 0}, {31, 0, 0}}), truth.trace, 0.0).segments_found == 1);
    CHECK(compare(line_of({{-30, 0, 0}, {0.1, 0, 0}, {0.9, 0, 0}, {31, 0, 0}}), truth.trace, 0.0).segments_found == 2);
}

TEST_CASE("a node of the truth without internodes takes no node of the trace")
{
    Drawing truth;
    truth.line(steps(0, 30, 2));
    truth.node({-0.5, 0, 0});
    const TraceComparison found = compare(line_of({{-10, 0, 0}, {-0.4, 0, 0}, {30, 0, 0}}), truth.trace, 0.0);
    CHECK(found.segments_found == 1);
    CHECK(found.wrong == 1);  // the part beyond the end
}

TEST_CASE("balls that just touch are near, and a large ball elsewhere makes no other one larger")
{
    const TraceGraph truth = line_of(steps(0, 30, 2));
    const auto beside = [&](double away) {
        return compare(line_of({{0, away, 0}, {15, away, 0}, {30, away, 0}}), truth, 0.5).segments_found;
    };
    CHECK(beside(2.5) == 1);
    CHECK(beside(2.5001) == 0);

    Drawing two;
    two.line(steps(3, 33, 2));
    two.line(steps(-4, -34, 2), 5.0);
    Drawing drawing;  // its first node touches only the larger end, which is farther away
    drawing.line({{-34, 0, 0}}, 5.0, drawing.node({0, 0, 0}));
    CHECK(compare(drawing.trace, two.trace, 0.0).segments_found == 1);
}

TEST_CASE("an internode that leaves a segment half way is none of its ways")
{
    const TraceGraph truth = line_of(steps(0, 60, 2));
    for (const bool outwards : {true, false}) {
        CAPTURE(outwards);
        Drawing drawing;
        const uint32_t before = drawing.line(steps(0, 30, 2));
        const uint32_t far = drawing.node({30.25, 40, 0}), after = drawing.node({30.5, 0, 0});
        for (const uint32_t near : {before, after}) outwards ? drawing.link(near, far) : drawing.link(far, near);
        drawing.line(steps(32, 60, 2), 1.0, after);
        CHECK(compare(drawing.trace, truth, 0.0).segments_found == 0);
        drawing.link(before, after);
        CHECK(compare(drawing.trace, truth, 0.0).segments_found == 1);
    }
}

TEST_CASE("a way that is near and passes over most of a segment has not found it")
{
    // A ring that is open between its ends, and a link from one of them to the other.
    Drawing open = ring(0, 58, 60);
    const glm::dvec3 first = open.trace.node(0).position, last = open.trace.node(58).position;
    CHECK(compare(line_of({first, last}), open.trace, 0.5).segments_found == 0);
}

TEST_CASE("a trace that goes along all of a segment and does not reach the node at its end has not found it")
{
    Drawing drawing;
    const uint32_t almost = drawing.line(steps(0, 29.5, 29.5 / 15));
    const uint32_t other = drawing.line({{29.8, 0.5, 0}, {29.8, -0.5, 0}}, 1.0, almost);
    drawing.link(other, almost);  // a small loop, to leave no loose end
    const uint32_t end = drawing.node({30, 0, 0});
    const TraceGraph truth = line_of(steps(0, 30, 2));
    CHECK(compare(drawing.trace, truth, 0.0).segments_found == 0);
    drawing.link(almost, end);
    CHECK(compare(drawing.trace, truth, 0.0).segments_found == 1);
}

TEST_CASE("a loop that hangs on a branch is found with that branch")
{
    Drawing truth = ring(0, 59, 60);
    truth.link(59, 0);
    truth.line({{35, 0, 0}, {50, 0, 0}}, 1.0, 0);
    Drawing without = ring(2, 58, 60);  // no node near the branch, though it is closed
    without.link(0, 56);
    CHECK(compare(without.trace, truth.trace, 0.1).segments_found == 0);
    CHECK(compare(truth.trace, truth.trace, 0.1).segments_found == 2);
}

TEST_CASE("a trace may go over from one segment to the next where they meet, whichever way either was drawn")
{
    const glm::dvec3 left(-30, 0, 0), right(30, 0, 0), up(0, 30, 0), middle(0, 0, 0);
    const std::vector<Places> orders = {
        {middle, left, right, up}, {left, middle, right, up}, {right, middle, left, up}, {left, right, up, middle}};
    for (const Places& order : orders) {
        Drawing truth;
        uint32_t key = 0;
        for (const glm::dvec3& place : order) {
            const uint32_t number = truth.node(place);
            if (place == middle) key = number;
        }
        for (uint32_t number = 0; number < 4; ++number)
            if (number != key) truth.link(number, key);
        // No node of the trace is near the branch, so nothing cuts it there.
        for (const Places& way : {Places{left, right}, Places{right, left}}) {
            const TraceComparison found = compare(line_of(way), truth.trace, 0.0);
            CHECK(found.wrong == 0);
            CHECK(found.topological_errors() == 0);
        }
    }
}

TEST_CASE("going along a segment twice is an error whichever way it is done")
{
    const TraceGraph truth = line_of(steps(0, 60, 2));
    for (const bool backwards : {false, true}) {
        CAPTURE(backwards);
        Drawing drawing;
        drawing.line(steps(0, 60, 2));
        Places again = {{10, 0.5, 0}, {30, 0.5, 0}, {50, 0.5, 0}};
        if (backwards) again = {again[2], again[1], again[0]};
        drawing.line(again);
        CHECK(compare(drawing.trace, truth, 0.0).doubled == 1);
    }
}

TEST_CASE("a way through the node that stands for another end is none")
{
    Drawing truth;
    truth.line(steps(0, 20, 2));
    truth.line({{10, 1, 0}, {10, 10, 0}});  // ends near the first one, and is not joined to it
    for (const bool joined : {true, false}) {
        CAPTURE(joined);
        Drawing drawing;
        const uint32_t begin = drawing.node({0, 0, 0}), end = drawing.node({20, 0, 0});
        const uint32_t other = drawing.line({{10, 10, 0}, {10, 0.6, 0}});
        const uint32_t middle = joined ? other : drawing.node({10, 0, 0});
        drawing.link(begin, middle);
        drawing.link(middle, end);
        CHECK(compare(drawing.trace, truth.trace, 0.0).segments_found == (joined ? 1 : 2));
    }
}

TEST_CASE("a part of a segment that hangs loose is no part of the way")
{
    const Drawing open = ring(0, 58, 60);
    Drawing drawing = ring(0, 57, 60);
    const uint32_t end = drawing.node(open.trace.node(58).position);
    drawing.link(0, end);  // a short cut, near the segment at both of its ends
    CHECK(compare(drawing.trace, open.trace, 0.5).segments_found == 0);
    drawing.link(57, end);
    CHECK(compare(drawing.trace, open.trace, 0.5).segments_found == 1);
}

TEST_CASE("of two segments side by side each is gone along once by a trace of both")
{
    const auto line_at = [](double y) {
        Places places = steps(0, 40, 2);
        for (glm::dvec3& place : places) place.y = y;
        return places;
    };
    for (const bool other_first : {true, false}) {
        CAPTURE(other_first);
        Drawing truth, drawing;
        for (const double y : {0.0, 1.2}) truth.line(line_at(y));
        for (const double y : {0.0, 1.2}) drawing.line(line_at(other_first ? 1.2 - y : y));
        const TraceComparison found = compare(drawing.trace, truth.trace, 0.0);
        CHECK(found.segments_found == 2);
        CHECK(found.topological_errors() == 0);
    }
}

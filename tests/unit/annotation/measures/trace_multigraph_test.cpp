// Traces in which several segments join the same two nodes: anastomoses, islands, loops.

#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "engine/annotation/measures/trace_score.h"
#include "tests/support/traces.h"

using namespace shvr;
using namespace shvr::test;

namespace {

using Random = std::mt19937;

double uniform(Random& random, double lower, double upper)
{
    return std::uniform_real_distribution<double>(lower, upper)(random);
}

glm::dvec3 anywhere(Random& random, double size)
{
    const double x = uniform(random, 0.0, size), y = uniform(random, 0.0, size);
    return {x, y, uniform(random, 0.0, size)};
}

/// Joins two nodes by a chain through new nodes at `places`.
void add_chain(GrowingTrace& drawing, uint32_t from, uint32_t to, const std::vector<glm::dvec3>& places, double radius)
{
    uint32_t last = from;
    for (const glm::dvec3& place : places) {
        const uint32_t next = drawing.node(place, radius);
        drawing.link(last, next);
        last = next;
    }
    drawing.link(last, to);
}

/// Random nodes, joined by random chains that cross, touch and run next to each other: between the same two nodes,
/// along the same course, in loops, and with nodes that are joined to nothing.
TraceGraph any_multigraph(Random& random)
{
    GrowingTrace drawing;
    const double largest = random() % 4 == 0 ? 0.0 : std::exp(uniform(random, -2.0, 2.5));
    const auto nodes = uint32_t(3 + random() % 6);
    for (uint32_t i = 0; i < nodes; ++i) drawing.node(anywhere(random, 30.0), uniform(random, 0.0, largest));
    const auto chains = 2 + random() % 8;
    std::vector<glm::dvec3> places;
    for (size_t i = 0; i < chains; ++i) {
        const auto from = uint32_t(random() % nodes), to = uint32_t(random() % nodes);
        const bool repeats_course = !places.empty() && random() % 4 == 0;
        if (!repeats_course) {
            places.clear();
            for (size_t count = 2 + random() % 3; count > 0; --count) places.push_back(anywhere(random, 30.0));
        }
        if (from != to && random() % 4 == 0 && !drawing.trace.internode_between(from, to))
            drawing.link(from, to);
        else
            add_chain(drawing, from, to, places, uniform(random, 0.0, largest));
    }
    if (random() % 3 == 0) {  // a loop that no branch lies on
        const uint32_t first = drawing.node(anywhere(random, 30.0), 1.0);
        add_chain(drawing, first, first, {anywhere(random, 30.0), anywhere(random, 30.0)}, 1.0);
    }
    return drawing.trace;
}

/// The same course with other nodes: internodes are divided anywhere.
TraceGraph divided(const TraceGraph& trace, Random& random)
{
    GrowingTrace drawing;
    std::map<uint32_t, uint32_t> numbers;
    for (const auto& [number, node] : trace.nodes()) numbers[number] = drawing.node(node.position, node.radius);
    for (const auto& [number, internode] : trace.internodes()) {
        const TraceNode &a = trace.node(internode.a), &b = trace.node(internode.b);
        uint32_t last = numbers[internode.a];
        double t = 0.0;
        for (size_t parts = random() % 3; parts > 0; --parts) {
            t += (1.0 - t) * uniform(random, 0.1, 0.9);
            const uint32_t next = drawing.node(glm::mix(a.position, b.position, t), glm::mix(a.radius, b.radius, t));
            drawing.link(last, next);
            last = next;
        }
        drawing.link(last, numbers[internode.b]);
    }
    return drawing.trace;
}

/// Two branches with three arms each, and between them two ways that are `apart` at most.
struct Island {
    GrowingTrace drawing;
    uint32_t left, right;

    explicit Island(double apart, bool has_upper = true, double moved = 0.0)
    {
        left = drawing.node({0, 0, 0}, 1.0);
        right = drawing.node({40, 0, 0}, 1.0);
        add_chain(drawing, left, drawing.node({-20, 10, 0}, 1.0), {{-10, 5, 0}}, 1.0);
        add_chain(drawing, left, drawing.node({-20, -10, 0}, 1.0), {{-10, -5, 0}}, 1.0);
        add_chain(drawing, right, drawing.node({60, 10, 0}, 1.0), {{50, 5, 0}}, 1.0);
        add_chain(drawing, right, drawing.node({60, -10, 0}, 1.0), {{50, -5, 0}}, 1.0);
        if (has_upper) add_way(0.5 * apart + moved);
        add_way(-0.5 * apart + moved);
    }
    void add_way(double y)
    {
        std::vector<glm::dvec3> places;
        for (int x = 2; x < 40; x += 2) places.emplace_back(x, y * std::sin(radians(4.5 * x)), 0);
        add_chain(drawing, left, right, places, 1.0);
    }
    static double radians(double degrees) { return degrees * 3.14159265358979 / 180.0; }
};

void check_counts(const TraceComparison& found, int64_t segments, int64_t wrong, int64_t doubled, int64_t gaps)
{
    CHECK(found.segments_found == segments);
    CHECK(found.wrong == wrong);
    CHECK(found.doubled == doubled);
    CHECK(found.gaps == gaps);
}

}  // namespace

TEST_CASE("two ways between two branches are no error")
{
    GrowingTrace drawing;
    for (const glm::dvec3& place : {glm::dvec3{10, 10, 10}, {30, 10, 10}, {20, 20, 10}, {0, 10, 10}, {40, 10, 10}})
        drawing.node(place, 1.0);
    for (const auto& [a, b] : {std::pair(0u, 1u), {0u, 2u}, {2u, 1u}, {0u, 3u}, {1u, 4u}}) drawing.link(a, b);
    const TraceComparison found = compare(drawing.trace, drawing.trace, 1.0);
    CHECK(found.segments_total == 4);
    check_counts(found, 4, 0, 0, 0);
}

TEST_CASE("any multigraph compared with itself, or with itself cut into other internodes, has no error")
{
    for (uint32_t seed = 0; seed < 60; ++seed) {
        CAPTURE(seed);
        Random random(seed);
        const TraceGraph trace = any_multigraph(random);
        const TraceGraph other = divided(trace, random);
        for (const double slack : {0.0, 0.5, 4.0}) {
            CAPTURE(slack);
            for (const auto& [found, limit] : {std::pair(compare(trace, trace, slack), 0.0),
                                               {compare(other, trace, slack), 1e-12},
                                               {compare(trace, other, slack), 1e-12}}) {
                check_counts(found, found.segments_total, 0, 0, 0);
                if (found.centreline_most) CHECK(*found.centreline_most <= std::max(limit, 1e-13));
            }
        }
    }
}

TEST_CASE("both ways around an island are told apart, however thin it is")
{
    for (const double apart : {1.0, 2.0, 4.0, 20.0}) {
        CAPTURE(apart);
        const Island truth(apart), one(apart, false), moved(apart, true, 0.2);
        check_counts(compare(moved.drawing.trace, truth.drawing.trace, 0.5), 6, 0, 0, 0);
        // A way that is missing is not found, even if the other one lies near it.
        check_counts(compare(one.drawing.trace, truth.drawing.trace, 0.5), 5, 0, 0, 0);
        // A surplus path is an error: next to the other one, or where the truth has none.
        const TraceComparison more = compare(truth.drawing.trace, one.drawing.trace, 0.5);
        CHECK(more.segments_found == 5);
        CHECK(more.doubled == (apart <= 2.0 ? 1 : 0));
        CHECK(more.wrong == (apart <= 2.0 ? 0 : 1));
    }
}

TEST_CASE("a way that is traced twice is an error, also beside another way")
{
    const Island truth(20.0);
    for (const double y : {10.5, 9.5, -10.7}) {
        CAPTURE(y);
        Island trace(20.0);
        trace.add_way(y);
        check_counts(compare(trace.drawing.trace, truth.drawing.trace, 0.5), 6, 0, 1, 0);
        trace.add_way(y + 0.1);
        check_counts(compare(trace.drawing.trace, truth.drawing.trace, 0.5), 6, 0, 2, 0);
    }
    // Twice the upper way and not the lower one: neither is an excuse for the other.
    Island trace(20.0, false);
    trace.add_way(-10.5);
    check_counts(compare(trace.drawing.trace, truth.drawing.trace, 0.5), 5, 0, 1, 0);
    // A loop traced twice.
    GrowingTrace ring, rings;
    for (GrowingTrace* drawing : {&ring, &rings}) {
        const uint32_t first = drawing->node({0, 0, 0}, 1.0);
        add_chain(*drawing, first, drawing->node({-10, 0, 0}, 1.0), {}, 1.0);
        for (const double side : {20.0, 20.5}) {
            if (drawing == &ring && side > 20.0) continue;
            add_chain(*drawing, first, first, {{side, 0, 0}, {side, side, 0}, {0, side, 0}}, 1.0);
        }
    }
    check_counts(compare(ring.trace, ring.trace, 0.5), 2, 0, 0, 0);
    check_counts(compare(rings.trace, ring.trace, 0.5), 2, 0, 1, 0);
}

TEST_CASE("a trace that changes from one way around an island to the other is wrong")
{
    const Island truth(20.0);
    Island trace(20.0, false);
    std::vector<glm::dvec3> places;
    for (int x = 2; x < 40; x += 2) {
        const double y = (x < 20 ? 10.0 : -10.0) * std::sin(Island::radians(4.5 * x));
        places.emplace_back(x, y, 0);
    }
    add_chain(trace.drawing, trace.left, trace.right, places, 1.0);
    check_counts(compare(trace.drawing.trace, truth.drawing.trace, 0.5), 5, 1, 0, 0);
}

TEST_CASE("the greatest distance between traces is that of the place farthest away, wherever it lies")
{
    const auto line = [](std::vector<glm::dvec3> places) {
        GrowingTrace drawing;
        const uint32_t first = drawing.node(places.front(), 1.0), last = drawing.node(places.back(), 1.0);
        add_chain(drawing, first, last, {places.begin() + 1, places.end() - 1}, 1.0);
        return drawing.trace;
    };
    const auto most = [](const TraceGraph& trace, const TraceGraph& truth) {
        return compare(trace, truth, 1.0).centreline_most.value();
    };
    // A peak off the truth: its one far node is the farthest point. A trace beyond the end: its end is.
    const TraceGraph truth = line({{0, 0, 0}, {100, 0, 0}});
    CHECK(most(line({{0, 0, 0}, {31, 17, 0}, {100, 0, 0}}), truth) == doctest::Approx(17.0).epsilon(1e-12));
    CHECK(most(line({{0, 0, 0}, {107, 0, 0}}), truth) == doctest::Approx(7.0).epsilon(1e-12));
    // A straight trace past a bend: farthest in the middle between two legs, where neither samples nor nodes lie.
    for (const double share : {0.5, 0.37, 0.0123}) {
        const double x = 100.0 * share, y = 30.0;
        const TraceGraph legs = line({{0, 1e4, 0}, {0, y, 0}, {0, 1e4, 1}, {2.0 * x, 1e4, 0}, {2.0 * x, y, 0}});
        const TraceGraph straight = line({{-5, 0, 0}, {105, 0, 0}});
        const double beyond = std::max(105.0 - 2.0 * x, 5.0);
        const double expected = std::max(std::hypot(x, y), std::hypot(beyond, y));
        CHECK(most(straight, legs) == doctest::Approx(expected).epsilon(2e-9));
    }
    // The trace is a helix of chords, the truth its axis: the chords' ends are farthest from it.
    std::vector<glm::dvec3> turns;
    for (int i = 0; i <= 200; ++i) turns.emplace_back(10.0 * std::cos(0.3 * i), 10.0 * std::sin(0.3 * i), 0.2 * i);
    CHECK(most(line(turns), line({{0, 0, 0}, {0, 0, 40}})) == doctest::Approx(10.0).epsilon(1e-12));
    // Against all pairs of places, for chains anywhere.
    for (uint32_t seed = 0; seed < 20; ++seed) {
        Random random(seed);
        std::vector<glm::dvec3> some, others;
        for (int i = 0; i < 5; ++i) some.push_back(anywhere(random, 10.0));
        for (int i = 0; i < 5; ++i) others.push_back(anywhere(random, 10.0));
        double expected = 0.0;
        constexpr int PLACES = 4000;
        for (size_t i = 1; i < some.size(); ++i)
            for (int k = 0; k <= PLACES; ++k) {
                const glm::dvec3 place = glm::mix(some[i - 1], some[i], double(k) / PLACES);
                double nearest = 1e300;
                for (size_t j = 1; j < others.size(); ++j) {
                    const glm::dvec3 way = others[j] - others[j - 1];
                    const double t = glm::clamp(glm::dot(place - others[j - 1], way) / glm::dot(way, way), 0.0, 1.0);
                    nearest = std::min(nearest, glm::length(place - others[j - 1] - t * way));
                }
                expected = std::max(expected, nearest);
            }
        const double found = most(line(some), line(others));
        CHECK(found >= expected * (1.0 - 2e-9));
        CHECK(found <= expected + 0.5 * 20.0 / PLACES);
    }
}

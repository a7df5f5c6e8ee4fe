// Mask to trace: parts and loops are those of the mask, lines run along the middle, and radii are those of the tubes.

#include <cmath>

#include "engine/annotation/measures/measures.h"
#include "engine/annotation/sets/thinning.h"
#include "engine/annotation/trace/trace_edit.h"
#include "engine/base/error.h"
#include "tests/support/slow.h"
#include "tests/unit/annotation/operations/operation_cases.h"

using namespace shvr;
using namespace shvr::test;

namespace {

DenseGroups unpainted(const Size3& size)
{
    return {size, std::vector<uint8_t>(size_t(size.x * size.y * size.z))};
}

/// Paints the voxels for which `is_in(centre)` holds, in physical positions.
template <class IsIn>
DenseGroups painted(const Size3& size, const glm::dvec3& spacing, const IsIn& is_in)
{
    DenseGroups dense = unpainted(size);
    reference::for_each_voxel(size, [&](const Size3& voxel) {
        if (is_in((glm::dvec3(voxel) + 0.5) * spacing)) dense.at(voxel) = 1;
    });
    return dense;
}

struct Traced {
    TraceGraph trace{};
    std::string note{};
};
Traced traced(const DenseGroups& dense, const glm::dvec3& spacing = {1, 1, 1}, TraceFromMaskOp op = {})
{
    const Mask mask = mask_of(dense);
    const VolumeInfo volume = PatternSource::info_of(dense.size, spacing);
    OperationResult result = run(op, {.mask = mask, .volume = volume});
    CHECK(result.changes.empty());
    Traced traced{.trace = {}, .note = result.note};
    for (const TraceChange& change : result.trace_changes) {
        CHECK(traced.trace.why_it_does_not_fit(change, Direction::forwards) == "");
        traced.trace.apply(change, Direction::forwards);
    }
    return traced;
}

/// As many parts and loops as the mask has; a cavity is filled, and is none of them.
void check_topology(const DenseGroups& dense, const TraceGraph& trace)
{
    DenseGroups solid = reference::wanted(FillHolesOp{.group = 1}, dense, {});
    const Topology of_mask = topology_of(mask_of(solid), uint8_t{1}), of_trace = topology_of(trace);
    CHECK(of_mask.cavities == 0);
    CHECK(of_trace.components == of_mask.components);
    CHECK(of_trace.loops == of_mask.loops);
}

int64_t ends_of(const TraceGraph& trace)
{
    return measure(trace).ends;
}

/// The topology of 3^3 voxels, as of a mask.
Topology topology_of_bits(uint32_t bits)
{
    DenseGroups dense = unpainted(Size3(5));
    reference::for_each_voxel(Size3(3), [&](const Size3& at) {
        dense.at(at + int64_t{1}) = uint8_t(bits >> (at.x + 3 * at.y + 9 * at.z) & 1u);
    });
    return topology_of(mask_of(dense), uint8_t{1});
}

/// A tube of radius `radius` around a closed or open curve, by the distance from many of its points.
template <class Curve>
auto around(const Curve& curve, double radius, int points = 200)
{
    std::vector<glm::dvec3> places;
    for (int i = 0; i <= points; ++i) places.push_back(curve(double(i) / points));
    return [places, radius](const glm::dvec3& at) {
        return std::ranges::any_of(places, [&](const glm::dvec3& place) { return glm::distance(at, place) <= radius; });
    };
}

/// The voxels within a radius of the way from one position to another.
auto tube(const glm::dvec3& from, const glm::dvec3& to, double radius)
{
    return [=](const glm::dvec3& at) {
        const glm::dvec3 way = to - from;
        const double t = std::clamp(glm::dot(at - from, way) / glm::dot(way, way), 0.0, 1.0);
        return glm::distance(at, from + t * way) <= radius;
    };
}

/// The largest distance of a node from a curve, and error of its radius.
template <class Curve>
glm::dvec2 errors_of(const TraceGraph& trace, const Curve& curve, double radius)
{
    glm::dvec2 worst(0.0);
    for (const auto& [number, node] : trace.nodes()) {
        double nearest = 1e300;
        for (int i = 0; i <= 1000; ++i) nearest = std::min(nearest, glm::distance(node.position, curve(i / 1000.0)));
        worst = glm::max(worst, glm::dvec2(nearest, std::abs(node.radius - radius)));
    }
    return worst;
}

}  // namespace

// Kind (operations on groups): neighbourhoods at random, against the topology of the voxels with and without the middle
TEST_CASE("a simple point is one whose removal changes no part, loop or cavity")
{
    std::mt19937 random(3);
    for (int i = 0; i < 100 * repeats(1, 50); ++i) {
        auto bits = uint32_t(random() | (i % 3 == 0 ? random() : 0u)) & ((1u << 27) - 1);
        if (i % 3 == 1) bits &= uint32_t(random());
        bits |= 1u << 13;
        const bool is_same = topology_of_bits(bits) == topology_of_bits(bits & ~(1u << 13));
        // A middle that touches nothing or is a part of a wall may keep the counts only if it is simple.
        if (is_simple_point(bits)) CHECK(is_same);
        if (!is_same) CHECK_FALSE(is_simple_point(bits));
    }
}

// Kind (operations on groups): noise at several densities, up to the volume's border
TEST_CASE("a trace from noise has the parts and loops of the noise")
{
    std::mt19937 random(17);
    for (int seed = 0; seed < repeats(2, 40); ++seed)
        for (const int share : {20, 50, 80}) {
            DenseGroups dense = unpainted({13 + seed % 3, 12, 35});
            for (uint8_t& voxel : dense.groups) voxel = int(random() % 100) < share;
            check_topology(dense, traced(dense).trace);
        }
}

TEST_CASE("a trace from overlapping balls has their parts and loops, whatever the spacing")
{
    std::mt19937 random(23);
    for (int seed = 0; seed < repeats(2, 20); ++seed) {
        const DenseGroups dense = random_groups(random, {35, 34, 33}, 20);
        check_topology(dense, traced(dense, seed % 2 == 0 ? glm::dvec3(1.0) : glm::dvec3(0.5, 1.0, 2.0)).trace);
    }
}

/// The share of voxels of a mask that its trace gives back: twice those in both, by the sum.
double dice_of(const DenseGroups& dense, const TraceGraph& trace, const glm::dvec3& spacing = {1, 1, 1})
{
    const Mask unpainted(dense.size);
    const VolumeInfo volume = PatternSource::info_of(dense.size, spacing);
    const OperationResult result =
        run(MaskFromTraceOp{.group = 1}, {.mask = unpainted, .volume = volume, .trace = &trace});
    Mask again = unpainted;
    apply(again, result.changes);
    int64_t both = 0, sum = 0;
    reference::for_each_voxel(dense.size, [&](const Size3& voxel) {
        both += dense.at(voxel) == 1 && again.at(voxel) == 1;
        sum += (dense.at(voxel) == 1) + (again.at(voxel) == 1);
    });
    return 2.0 * double(both) / double(sum);
}

// Kind (operations on groups): tubes along and across the grid, in the middle of voxels and at their corners
TEST_CASE("a straight tube becomes one line along its axis, with its radius")
{
    const std::pair<glm::dvec3, glm::dvec3> axes[] = {{{12, 12.5, 12.5}, {60, 20, 15}},
                                                      {{12, 16, 15}, {60, 16, 15}},
                                                      {{12.5, 16.5, 15.5}, {60.5, 16.5, 15.5}},
                                                      {{12, 16.3, 15.2}, {60, 16.3, 15.2}},
                                                      {{16, 10, 9}, {32, 26, 25}}};
    for (const auto& [from, to] : axes)
        for (const double radius : {1.5, 4.2, 6.3}) {
            const auto axis = [&](double t) { return glm::mix(from, to, t); };
            const DenseGroups dense = painted({72, 36, 33}, glm::dvec3(1), tube(from, to, radius));
            const Traced found = traced(dense);
            check_topology(dense, found.trace);
            CHECK(ends_of(found.trace) == 2);
            const glm::dvec2 errors = errors_of(found.trace, axis, radius);
            const double dice = dice_of(dense, found.trace);
            INFO("radius " << radius << " at " << from.y << ": off " << errors.x << ", radius off " << errors.y
                           << ", Dice " << dice << "; " << found.note);
            CHECK(errors.x < 0.4);
            CHECK(errors.y < 0.45);
            CHECK(dice > (radius < 4.0 ? 0.7 : 0.95));
            CHECK(found.trace.nodes().size() <= 4);
        }
}

/// The largest distance of a place on the axis from the nearest place on an internode.
double uncovered(const TraceGraph& trace, const glm::dvec3& from, const glm::dvec3& to)
{
    double worst = 0.0;
    for (int i = 0; i <= 100; ++i) {
        const glm::dvec3 at = glm::mix(from, to, i / 100.0);
        double nearest = 1e300;
        for (const auto& [number, internode] : trace.internodes()) {
            const glm::dvec3 a = trace.node(internode.a).position, way = trace.node(internode.b).position - a;
            const double t = std::clamp(glm::dot(at - a, way) / std::max(glm::dot(way, way), 1e-9), 0.0, 1.0);
            nearest = std::min(nearest, glm::distance(at, a + t * way));
        }
        worst = std::max(worst, nearest);
    }
    return worst;
}

// Kind (operations on groups): widths of an even number of voxels, where each end could be eaten along the whole line
TEST_CASE("a line covers the length of its tube, except about a radius at each end, in every direction")
{
    std::mt19937 random(5);
    const auto number = [&] { return double(random()) / 4294967296.0; };
    std::vector<glm::dvec3> directions{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int i = 0; i < repeats(12, 200); ++i)
        directions.push_back(glm::normalize(glm::dvec3(number(), number(), number()) - 0.5));
    for (const glm::dvec3& direction : directions)
        for (const double centre : {19.7, 20.0, 20.1, 20.5})
            for (const double radius : {1.5, 2.0, 4.0}) {
                const glm::dvec3 from = glm::dvec3(centre) - 12.0 * direction, to = from + 24.0 * direction;
                const Traced found = traced(painted({40, 40, 40}, glm::dvec3(1), tube(from, to, radius)));
                INFO("direction " << direction.x << " " << direction.y << " " << direction.z << ", centre " << centre
                                  << ", radius " << radius << "; " << found.note);
                CHECK(ends_of(found.trace) == 2);
                CHECK(uncovered(found.trace, from, to) < radius + 1.2);
            }
}

// Kind (operations on groups): tubes that close, twist, branch and touch
TEST_CASE("a ring and a helix become lines along their courses")
{
    const auto ring = [](double t) {
        return glm::dvec3(20, 20, 8) + 12.0 * glm::dvec3(std::cos(6.2831853 * t), std::sin(6.2831853 * t), 0);
    };
    DenseGroups dense = painted({40, 40, 16}, glm::dvec3(1), around(ring, 3.2));
    Traced found = traced(dense);
    check_topology(dense, found.trace);
    CHECK(topology_of(found.trace) == Topology{.components = 1, .loops = 1});
    CHECK(ends_of(found.trace) == 0);
    glm::dvec2 errors = errors_of(found.trace, ring, 3.2);
    INFO("ring: off " << errors.x << ", radius off " << errors.y << "; " << found.note);
    CHECK(errors.x < 0.4);
    CHECK(errors.y < 0.45);

    const auto helix = [](double t) {
        return glm::dvec3(10, 10, 4 + 24 * t) + 6.0 * glm::dvec3(std::cos(12.566 * t), std::sin(12.566 * t), 0);
    };
    dense = painted({20, 20, 64}, {1, 1, 0.5}, around(helix, 2.4));
    found = traced(dense, {1, 1, 0.5});
    check_topology(dense, found.trace);
    CHECK(ends_of(found.trace) == 2);
    errors = errors_of(found.trace, helix, 2.4);
    INFO("helix: off " << errors.x << ", radius off " << errors.y << "; " << found.note);
    CHECK(errors.x < 0.4);
    CHECK(errors.y < 0.45);
}

// Kind (operations on groups): junctions of thick and thin tubes, where thinning leaves several branches
TEST_CASE("tubes that cross have nodes only where lines leave the junction, fewer with a larger tolerance")
{
    for (const double thin : {1.6, 3.0}) {
        const auto thick_tube = tube({8, 10, 12.3}, {52, 38, 12.3}, 4.2);
        const DenseGroups dense = painted({60, 48, 24}, glm::dvec3(1), [&](const glm::dvec3& at) {
            return thick_tube(at) || tube({8, 38.2, 12}, {52, 10.2, 12}, thin)(at);
        });
        const Traced found = traced(dense);
        check_topology(dense, found.trace);
        INFO("thin " << thin << ": " << found.note << ", Dice " << dice_of(dense, found.trace));
        CHECK(ends_of(found.trace) == 4);
        CHECK(measure(found.trace).branches.size() <= 2);
        CHECK(found.trace.nodes().size() <= 8);  // of them four where the lines leave the ball
        CHECK(dice_of(dense, found.trace) > 0.9);
        const Traced wide = traced(dense, glm::dvec3(1), {.tolerance = 4.5});
        check_topology(dense, wide.trace);
        CHECK(measure(wide.trace).branches.size() <= 2);
        CHECK(wide.trace.nodes().size() <= 6);
    }
}

TEST_CASE("a group that takes more memory than the budget is refused before it is taken")
{
    const DenseGroups dense = painted({40, 20, 20}, glm::dvec3(1), [](const glm::dvec3&) { return true; });
    const Mask mask = mask_of(dense);
    const VolumeInfo volume = PatternSource::info_of(dense.size, {1, 1, 1});
    for (const uint64_t memory : {uint64_t{10'000}, uint64_t{30'000}, uint64_t{60'000}})
        CHECK_THROWS_WITH_AS(
            static_cast<void>(run(TraceFromMaskOp{}, {.mask = mask, .volume = volume, .memory = memory})),
            doctest::Contains("MiB of memory; expected at most 1 MiB, the budget of the host"), Error);
    CHECK_NOTHROW(static_cast<void>(run(TraceFromMaskOp{}, {.mask = mask, .volume = volume, .memory = 8 << 20})));
}

TEST_CASE("a conversion that is cancelled at any stage ends there")
{
    const DenseGroups dense = painted({20, 10, 10}, glm::dvec3(1), [](const glm::dvec3&) { return true; });
    const Mask mask = mask_of(dense);
    const VolumeInfo volume = PatternSource::info_of(dense.size, {1, 1, 1});
    std::vector<double> told;
    const OperationInput input{.mask = mask, .volume = volume};
    static_cast<void>(run(TraceFromMaskOp{}, input, [&](double fraction) { told.push_back(fraction); }));
    CHECK(std::ranges::is_sorted(told));
    CHECK(told.back() == 1.0);
    for (const double end : {0.0, 0.1, 0.3, 0.87})
        CHECK_THROWS_WITH_AS(static_cast<void>(run(TraceFromMaskOp{}, input,
                                                   [&](double fraction) {
                                                       if (fraction >= end) throw Stopped("stopped");
                                                   })),
                             "stopped", Stopped);
}

TEST_CASE("a side line stays if it reaches further than spurs do")
{
    const auto in_trunk = tube({8, 20, 12}, {52, 20, 12}, 4.2), in_branch = tube({30, 20, 12}, {44, 44, 12}, 2.6),
               in_bump = tube({20.5, 20, 12.5}, {20.5, 12.5, 12.5}, 0.6);
    const DenseGroups dense = painted({60, 52, 24}, glm::dvec3(1), [&](const glm::dvec3& at) {
        return in_trunk(at) || in_branch(at) || in_bump(at);
    });
    const Traced found = traced(dense);
    check_topology(dense, found.trace);
    INFO(found.note);
    CHECK(ends_of(found.trace) == 4);  // the bump reaches at least 7 voxels, more than 1.5 radii
    const Traced without = traced(dense, glm::dvec3(1), {.spur = 2.5});
    check_topology(dense, without.trace);
    INFO(without.note);
    CHECK(ends_of(without.trace) == 3);
    CHECK(measure(without.trace).branches.size() == 1);
    CHECK(without.note.find("1 spur was left out") != std::string::npos);
}

TEST_CASE("a cavity is filled first and reported")
{
    const DenseGroups dense = painted({24, 24, 24}, glm::dvec3(1), [](const glm::dvec3& at) {
        const double away = glm::distance(at, glm::dvec3(12));
        return away <= 9.0 && away > 1.1;
    });
    const Traced found = traced(dense);
    check_topology(dense, found.trace);
    CHECK(found.note.find("cavities of 8 voxels were filled before") != std::string::npos);
    CHECK(found.trace.nodes().size() <= 2);
}

TEST_CASE("a whole painted volume, a voxel and an unpainted group")
{
    DenseGroups dense = painted({9, 6, 5}, glm::dvec3(1), [](const glm::dvec3&) { return true; });
    check_topology(dense, traced(dense).trace);
    dense = unpainted({9, 6, 5});
    dense.at({8, 5, 4}) = 1;
    const TraceGraph trace = traced(dense).trace;
    CHECK(trace.nodes().size() == 1);
    CHECK((trace.node(0) == TraceNode{.position = {8.5, 5.5, 4.5}, .radius = 0.5, .group = 1}));
    CHECK_THROWS_WITH_AS(static_cast<void>(traced(unpainted({4, 4, 4}))),
                         "group 1 has no voxels; expected some to trace", Error);
}

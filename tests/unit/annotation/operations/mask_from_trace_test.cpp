// Trace to mask, against tests/reference/group_operations.h.

#include "engine/annotation/trace/trace_edit.h"
#include "engine/base/error.h"
#include "tests/unit/annotation/operations/operation_cases.h"

using namespace shvr;
using namespace shvr::test;

namespace {

void add(TraceGraph& trace, const TraceNode& node)
{
    for (const TraceChange& change : add_node(trace, node)) trace.apply(change, Direction::forwards);
}

void set_internode_size(TraceGraph& trace, uint8_t group, double radius)
{
    for (const TraceChange& change : set_internode_radius(trace, group, radius))
        trace.apply(change, Direction::forwards);
}

/// A chain of nodes in a volume and around it, with radii from 0 up; some nodes hold their neighbours.
TraceGraph random_trace(std::mt19937& random, const glm::dvec3& extent)
{
    std::uniform_real_distribution<double> share(-0.1, 1.1);
    TraceGraph trace;
    for (int i = 0; i < 9; ++i) {
        if (i % 4 == 3) trace.select({});
        const double radius = i % 3 == 0 ? 0.0 : i == 7 ? extent.x * 0.4 : 6.0 * std::abs(share(random));
        add(trace, {.position = glm::dvec3(share(random), share(random), share(random)) * extent,
                    .radius = radius,
                    .group = uint8_t(1 + random() % 3)});
    }
    return trace;
}

DenseGroups unpainted(const Size3& size)
{
    return {size, std::vector<uint8_t>(size_t(size.x * size.y * size.z))};
}

}  // namespace

// Kind (operations on groups): balls inside balls, radii of 0, nodes outside the volume, anisotropic spacing
TEST_CASE("a mask from a trace agrees with its definition, whatever limits and locks")
{
    std::mt19937 random(11);
    for (const Size3& size : {Size3(33, 31, 1), Size3(34, 9, 20)})
        for (int i = 0; i < 3; ++i) {
            const glm::dvec3 spacing = i == 0 ? glm::dvec3(1.0) : glm::dvec3(0.5, 0.75, 1.25);
            TraceGraph trace = random_trace(random, glm::dvec3(size) * spacing);
            if (i == 1) set_internode_size(trace, 2, 2.5);
            MaskFromTraceOp op{.group = 2};
            if (i == 1) op.of = {2, 3};
            GroupSet locked;
            if (i == 2) {
                op.limits = random_limits(random, size);
                locked[1 + random() % 4] = true;
            }
            check_operation(op, random_groups(random, size), spacing, locked, &trace);
        }
}

// Kind (operations on groups): distances that whole voxels reach exactly
TEST_CASE("a voxel whose centre is at the radius belongs to a ball or cone")
{
    TraceGraph trace;
    add(trace, {.position = glm::dvec3(10.5) * 0.1, .radius = 0.3, .group = 1});
    OperationResult result =
        check_operation(MaskFromTraceOp{.group = 1}, unpainted({40, 21, 21}), glm::dvec3(0.1), {}, &trace);
    CHECK(result.voxels == 123);  // lattice points within 3 of the origin
    add(trace, {.position = glm::dvec3(20.5, 10.5, 10.5) * 0.1, .radius = 0.3, .group = 1});
    result = check_operation(MaskFromTraceOp{.group = 1}, unpainted({40, 21, 21}), glm::dvec3(0.1), {}, &trace);
    CHECK(result.voxels == 123 + 10 * 29);  // and 29 points of each slice within 3 of the axis
}

TEST_CASE("a mask from a trace costs the bricks that the trace meets")
{
    const Size3 size(int64_t{1} << 20);
    const VolumeInfo volume = PatternSource::info_of(size, {1, 1, 1});
    const Mask mask(size);
    TraceGraph trace;
    add(trace, {.position = glm::dvec3(1000.5), .radius = 1.0, .group = 1});
    add(trace, {.position = glm::dvec3(1000.5 + 3200.0), .radius = 1.0, .group = 1});
    const OperationResult result = run(MaskFromTraceOp{.group = 5}, {.mask = mask, .volume = volume, .trace = &trace});
    CHECK(result.voxels > 3200);
    CHECK(result.bricks_written >= 100);
    CHECK(result.bricks_written <= 720);  // the line meets corners of bricks, each of eight
    CHECK(result.bricks_read <= 5 * result.bricks_written);
}

TEST_CASE("a mask from a trace without nodes, or without the groups, is refused")
{
    const Mask mask(Size3(8));
    const VolumeInfo volume = PatternSource::info_of(Size3(8), {1, 1, 1});
    TraceGraph trace;
    CHECK_THROWS_WITH_AS(static_cast<void>(run(MaskFromTraceOp{}, {.mask = mask, .volume = volume, .trace = &trace})),
                         "the trace has no nodes; expected some to paint", Error);
    add(trace, {.position = glm::dvec3(4.0), .radius = 1.0, .group = 1});
    CHECK_THROWS_WITH_AS(
        static_cast<void>(run(MaskFromTraceOp{.of = {7}}, {.mask = mask, .volume = volume, .trace = &trace})),
        "key of is [7]; expected groups of which the trace has nodes or internodes", Error);
}

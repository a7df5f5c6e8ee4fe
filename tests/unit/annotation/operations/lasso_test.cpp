// Cutting by an outline in a view; against tests/reference/group_operations.h.

#include "engine/base/error.h"
#include "tests/unit/annotation/operations/operation_cases.h"

using namespace shvr;
using namespace shvr::test;

using Side = LassoOp::Side;
using Face = LassoView::Face;
using Projection = LassoView::Projection;

namespace {

double between(std::mt19937& random, double lower, double upper)
{
    return lower + (upper - lower) * double(random() % 1'000'001) / 1'000'000.0;
}

/// An outline that crosses itself, around the middle of the volume as the view shows it.
std::vector<glm::dvec2> random_outline(std::mt19937& random, double reach)
{
    std::vector<glm::dvec2> outline;
    for (uint32_t i = 3 + uint32_t(random() % 20); i > 0; --i)
        outline.emplace_back(between(random, -reach, reach), between(random, -reach, reach));
    return outline;
}

/// From a slice across an axis: x and y of the picture are axes of the volume, so that centres lie on sides.
LassoView slice_view(int axis)
{
    LassoView view{.eye = glm::dvec3(0.0), .target = glm::dvec3(0.0), .up = glm::dvec3(0.0)};
    view.target[axis] = axis == 1 ? 1.0 : -1.0;
    view.up[axis == 2 ? 1 : 2] = 1.0;
    return view;
}

}  // namespace

// Kind (operations on groups): outlines that cross themselves, eyes in the volume, views along and across the grid
TEST_CASE("cuts agree with their definition, from any eye and in slices, whatever limits, locks and depths")
{
    std::mt19937 random(51);
    const glm::dvec3 spacings[] = {{1, 1, 1}, {0.5, 0.75, 1.25}, {3e-3, 2e-3, 2e-3}, {1, 2, 3}};
    for (size_t i = 0; i < std::size(ODD_SIZES); ++i)
        for (int kind = 0; kind < 6; ++kind) {
            CAPTURE(i);
            CAPTURE(kind);
            const glm::dvec3 extent = glm::dvec3(ODD_SIZES[i]) * spacings[i];
            const auto somewhere = [&](double beyond) {
                return glm::dvec3(between(random, -beyond, 1.0 + beyond), between(random, -beyond, 1.0 + beyond),
                                  between(random, -beyond, 1.0 + beyond)) *
                       extent;
            };
            const double length = glm::length(extent);
            const bool is_perspective = kind % 2 == 0;
            LassoOp op{.to_group = kind == 5 ? 2 : 0,
                       .groups = kind < 3 ? std::vector<uint8_t>{} : std::vector<uint8_t>{1, 3},
                       .view = {Face::none, is_perspective ? Projection::perspective : Projection::orthographic,
                                somewhere(kind < 4 ? 2.0 : 0.0), somewhere(0.0), somewhere(1.0) + 1e-3 * length},
                       .polygon = random_outline(random, is_perspective ? 0.5 : 0.4 * length),
                       .side = random() % 2 == 0 ? Side::inside : Side::outside};
            REQUIRE(axes_of(op.view).is_valid);
            const DenseGroups before = random_groups(random, ODD_SIZES[i]);
            check_operation(op, before, spacings[i]);
            const double nearest = between(random, 0.0, 0.5 * length);
            op.depth = glm::dvec2(nearest, nearest + between(random, 0.0, length));
            op.limits = random_limits(random, ODD_SIZES[i]);
            GroupSet locked;
            locked[1 + random() % 3] = true;
            check_operation(op, before, spacings[i], locked);
        }
}

// Kind (operations on groups): outlines whose sides run through centres of voxels
TEST_CASE("of centres on an outline, those on its lower and left sides are inside, in slices across every axis")
{
    DenseGroups before{{40, 37, 35}, std::vector<uint8_t>(size_t(40 * 37 * 35), 1)};
    for (int axis = 0; axis < 3; ++axis) {
        LassoOp op{.view = slice_view(axis), .polygon = {{4.5, 3.5}, {33.5, 3.5}, {33.5, 20.5}, {4.5, 20.5}}};
        const OperationResult result = check_operation(op, before);
        CHECK(result.voxels == 29 * 17 * before.size[axis]);
        op.polygon = {{4.5, 3.5}, {24.5, 23.5}, {4.5, 23.5}};  // a slope through centres
        check_operation(op, before);
        op.polygon = {{4.5, 3.5}, {33.5, 3.5}, {4.5, 23.5}, {33.5, 23.5}};  // a bow
        check_operation(op, before);
        const double sign = axis == 1 ? 1.0 : -1.0;
        op.depth = glm::dvec2(std::min(sign * 5.5, sign * 7.5), std::max(sign * 5.5, sign * 7.5));
        op.polygon = {{0, 0}, {50, 0}, {50, 50}, {0, 50}};
        CHECK(check_operation(op, before).voxels == 3 * int64_t(before.groups.size()) / before.size[axis]);
        op.side = Side::outside;
        CHECK(check_operation(op, before).voxels == 0);
    }
}

TEST_CASE("views from faces of the volume have their origin in the lower left corner that is seen")
{
    std::mt19937 random(52);
    const Size3 size(40, 33, 21);
    const glm::dvec3 spacing(0.5, 1.0, 2.0);
    const DenseGroups before = random_groups(random, size);
    for (const Spelling<Face>& face : LASSO_FACES) {
        CAPTURE(face.name);
        const LassoView view{.face = face.value};
        check_operation(LassoOp{.view = view, .polygon = {{0, 0}, {12, 0}, {12, 9}}}, before, spacing);
        const LassoOp slab{
            .view = view, .polygon = {{-9, -9}, {99, -9}, {99, 99}, {-9, 99}}, .depth = glm::dvec2(0, 4)};
        CHECK(check_operation(slab, before, spacing).voxels > 0);
    }
}

TEST_CASE("cuts cost the painted bricks that they reach, and stop when they are told to")
{
    const Size3 size(1 << 20, 1 << 20, 1 << 20);
    Mask mask(size);
    const VolumeInfo volume = PatternSource::info_of(size, {1, 1, 1});
    for (int64_t i = 0; i < 20; ++i) {
        MaskBrickChange change{.brick = index_of(Size3(1000 * i, 5, 7), mask.brick_counts()), .runs = {}};
        append_run(change.runs, 0, VOXELS_PER_BRICK - 1, uint8_t{0}, uint8_t{1});
        mask.apply(change, Direction::forwards);
    }
    LassoView view = slice_view(2);
    const double first = 32.0 * 3000 + 7.0;
    LassoOp op{.view = view, .polygon = {{first, 0}, {32.0 * 6000 + 40.0, 0}, {32.0 * 6000 + 40.0, 1e6}, {first, 1e6}}};
    const OperationInput input{.mask = mask, .volume = volume};
    OperationResult result = run(op, input);
    CHECK(result.voxels == int64_t{32 * 32} * (25 + 32 * 3));
    CHECK(result.bricks_read == 4);
    CHECK(result.bricks_written == 4);
    op.depth = glm::dvec2(0.0, 1e9);  // the other way
    CHECK(run(op, input).bricks_read == 0);
    int calls = 0;
    const auto stop = [&](double) {
        if (++calls == 3) throw Stopped("stopped");
    };
    CHECK_THROWS_AS(static_cast<void>(run(op, input, stop)), Stopped);
}

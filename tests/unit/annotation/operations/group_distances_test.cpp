// Operations by distance: grow, shrink, open, close, hollow; against tests/reference/group_operations.h.

#include "tests/support/slow.h"
#include "tests/unit/annotation/operations/operation_cases.h"

using namespace shvr;
using namespace shvr::test;

namespace {

using Side = HollowOp::Side;

}  // namespace

// Kind (operations on groups): distances that whole voxels reach exactly, anisotropic spacing, borders of bricks
TEST_CASE("operations by distance agree with their definitions")
{
    std::mt19937 random(11);
    // The reference visits a ball around each voxel: every day a quarter of the voxels, across borders along each axis.
    const Size3 small[] = {{33, 31, 1}, {32, 34, 5}, {66, 13, 7}, {9, 13, 34}};
    const Size3 large[] = {{33, 31, 1}, {32, 34, 9}, {66, 13, 20}, {35, 33, 34}};
    const auto& sizes = is_slow() ? large : small;
    const glm::dvec3 spacings[] = {{1, 1, 1}, {0.1, 0.3, 0.2}, {2, 0.7, 1.1}, {3e-7, 2e-7, 2e-7}};
    for (size_t i = 0; i < std::size(spacings); ++i) {
        const Size3 size = sizes[i];
        const glm::dvec3& spacing = spacings[i];
        const DenseGroups before = random_groups(random, size);
        for (const double voxels : {0.9, 1.0, 2.0}) {
            const double distance = voxels * spacing.x;
            CAPTURE(distance);
            const auto with_limits = [&](auto op) {
                check_operation(op, before, spacing);
                op.limits = random_limits(random, size);
                GroupSet locked;
                locked[1 + random() % 4] = true;
                check_operation(op, before, spacing, locked);
            };
            with_limits(GrowOp{.group = 1, .distance = distance});
            with_limits(ShrinkOp{.group = 2, .distance = distance});
            if (voxels == 0.9) continue;
            with_limits(OpenOp{.group = 3, .distance = distance});
            with_limits(CloseOp{.group = 4, .distance = distance});
            for (const Side side : {Side::in, Side::out, Side::both})
                with_limits(HollowOp{.group = 1, .wall = distance, .side = side});
        }
    }
}

TEST_CASE("a voxel grows into a ball of exactly its distance, across bricks")
{
    DenseGroups before{{48, 39, 36}, std::vector<uint8_t>(48 * 39 * 36)};
    before.at({33, 32, 31}) = 1;
    CHECK(check_operation(GrowOp{.group = 1, .distance = 1.0}, before).voxels == 6);
    CHECK(check_operation(GrowOp{.group = 1, .distance = 0.3}, before, {0.1, 0.1, 0.1}).voxels == 122);
    const OperationResult result = check_operation(GrowOp{.group = 1, .distance = 13.0}, before, {1, 2, 3});
    int64_t inside = 0;
    for (int64_t z = -4; z <= 4; ++z)
        for (int64_t y = -6; y <= 6; ++y)
            for (int64_t x = -13; x <= 13; ++x) inside += x * x + 4 * y * y + 9 * z * z <= 169;
    CHECK(result.voxels == inside - 1);
}

// Kind (operations on groups): distances measured by rows of bits, and those just beyond, in tiles
TEST_CASE("distances of many voxels agree with their definition, across bricks and at the volume's border")
{
    std::mt19937 random(12);
    const Size3 size(40, 36, 34);
    DenseGroups few{size, std::vector<uint8_t>(size_t(40 * 36 * 34))}, most = few;
    most.groups.assign(most.groups.size(), 1);
    for (int i = 0; i < 6; ++i) {
        const size_t at = random() % few.groups.size();
        few.groups[at] = 1;
        most.groups[at] = uint8_t(i % 3);
    }
    std::vector<double> distances{16.0, 17.0};
    if (repeats(0, 1) > 0) distances.insert(distances.end(), {5.0, 15.99, 16.99, 20.0});
    const glm::dvec3 spacing(1, 4, 6.3);  // few voxels within these distances, for the sake of the reference
    for (const double distance : distances) {
        CAPTURE(distance);
        CHECK(check_operation(GrowOp{.group = 1, .distance = distance}, few, spacing).voxels > 100);
        CHECK(check_operation(ShrinkOp{.group = 1, .distance = distance}, most, spacing).voxels > 100);
    }
}

TEST_CASE("the volume's border is no outside: a full volume neither shrinks nor opens, and closing reaches it")
{
    DenseGroups before{{40, 33, 20}, std::vector<uint8_t>(40 * 33 * 20, 2)};
    CHECK(check_operation(ShrinkOp{.group = 2, .distance = 3.0}, before).voxels == 0);
    CHECK(check_operation(OpenOp{.group = 2, .distance = 3.0}, before).voxels == 0);
    CHECK(check_operation(HollowOp{.group = 2, .wall = 2.0, .side = Side::in}, before).voxels == 40 * 33 * 20);
    before.at({0, 10, 10}) = 0;
    CHECK(check_operation(CloseOp{.group = 2, .distance = 1.0}, before).voxels == 1);
}

TEST_CASE("operations by distance cost the surroundings of the group, not the volume")
{
    const Size3 size(1 << 20, 1 << 20, 1 << 20);
    Mask mask(size);
    const VolumeInfo volume = PatternSource::info_of(size, {1, 1, 1});
    const Size3 at(1'000'016, 500'016, 31);
    mask.apply({.brick = index_of(at / BRICK_SIDE, mask.brick_counts()),
                .runs = {{uint16_t(index_in_brick(at)), uint16_t(index_in_brick(at)), 0, 1}}},
               Direction::forwards);
    const OperationInput input{.mask = mask, .volume = volume};
    const OperationResult result = run(GrowOp{.group = 1, .distance = 3.0}, input);
    CHECK(result.voxels == 122);
    CHECK(result.bricks_written == 2);
    CHECK(result.bricks_read == 3);
    CHECK(run(ShrinkOp{.group = 1, .distance = 3.0}, input).bricks_read == 2);
    std::string failure;
    try {
        static_cast<void>(run(GrowOp{.group = 1, .distance = 600.0}, input));
    } catch (const Error& error) {
        failure = error.what();
    }
    CHECK(failure == "the distance is 600, 600 voxels along x; expected at most 512 voxels");
}

// Filling between painted slices; against tests/reference/group_operations.h.

#include "engine/base/error.h"
#include "tests/unit/annotation/operations/operation_cases.h"

using namespace shvr;
using namespace shvr::test;

using Axis = FillBetweenOp::Axis;

namespace {

/// Leaves group `group` only in every `step`th slice.
DenseGroups sliced(DenseGroups dense, int axis, int64_t step, uint8_t group = 1)
{
    reference::for_each_voxel(dense.size, [&](const Size3& voxel) {
        if (voxel[axis] % step != 0 && dense.at(voxel) == group) dense.at(voxel) = 0;
    });
    return dense;
}

template <class IsIn>
DenseGroups painted(const Size3& size, const IsIn& is_in)
{
    DenseGroups dense{size, std::vector<uint8_t>(size_t(size.x * size.y * size.z))};
    reference::for_each_voxel(size, [&](const Size3& voxel) { dense.at(voxel) = is_in(voxel) ? 1 : 0; });
    return dense;
}

}  // namespace

// Kind (operations on groups): painted slices at borders of bricks, shapes with holes, anisotropic spacing
TEST_CASE("filling between slices agrees with its definition along every axis, whatever limits and locks")
{
    std::mt19937 random(31);
    const Size3 sizes[] = {{70, 9, 7}, {7, 67, 9}, {9, 8, 70}, {35, 12, 1}};
    const glm::dvec3 spacings[] = {{1, 1, 1}, {0.5, 0.75, 1.25}, {3e-7, 2e-7, 2e-7}, {1, 2, 3}};
    for (size_t i = 0; i < std::size(sizes); ++i)
        for (const Axis axis : {Axis::x, Axis::y, Axis::z}) {
            CAPTURE(i);
            FillBetweenOp op{.group = 1, .axis = axis};
            const DenseGroups before = sliced(random_groups(random, sizes[i]), int(axis), 2 + int64_t(random() % 6));
            check_operation(op, before, spacings[i]);
            op.limits = random_limits(random, sizes[i]);
            GroupSet locked;
            locked[2 + random() % 3] = true;
            check_operation(op, before, spacings[i], locked);
        }
}

// Kind (operations on groups): shapes that touch the volume's border, and a painted slice without a voxel outside
TEST_CASE("a box and a cone come back from a few of their slices")
{
    const Size3 size(40, 36, 67);
    const DenseGroups box = painted(size, [](const Size3&voxel) { return voxel.x < 9 && voxel.y > 30; }),
                      whole = painted(size, [](const Size3&) { return true; }),
                      cone = painted(size, [](const Size3&voxel) {
                          const Size3 away = voxel - Size3(20, 18, 0);
                          return 4 * (away.x * away.x + away.y * away.y) <= (70 - voxel.z / 3) * (70 - voxel.z / 3) / 4;
                      });
    for (const DenseGroups* shape : {&box, &whole, &cone}) {
        const DenseGroups before = sliced(*shape, 2, 6);
        Mask mask = mask_of(before);
        const VolumeInfo volume = PatternSource::info_of(size, {1, 1, 1});
        const OperationResult result = run(FillBetweenOp{.group = 1}, {.mask = mask, .volume = volume});
        apply(mask, result.changes);
        int64_t wrong = 0, voxels = 0;
        const DenseGroups after = dense_of(mask);
        reference::for_each_voxel(size, [&](const Size3& voxel) {
            wrong += (after.at(voxel) != 0) != (shape->at(voxel) != 0);
            voxels += shape->at(voxel) != 0;
        });
        if (shape == &cone)  // whose outline falls by steps of a voxel
            CHECK(40 * wrong < voxels);
        else
            CHECK(wrong == 0);
    }
}

TEST_CASE("shapes that share voxels are joined, and those that do not even touch are not")
{
    const auto bars = [](int64_t apart) {
        return painted({30, 12, 11}, [&](const Size3& voxel) {
            const int64_t x = voxel.x - (voxel.z == 10 ? apart : 0);
            return (voxel.z == 0 || voxel.z == 10) && x >= 4 && x < 10 && voxel.y >= 3 && voxel.y < 9;
        });
    };
    for (const int64_t apart : {0, 3, 5, 7, 9}) {
        const DenseGroups before = bars(apart);
        Mask mask = mask_of(before);
        const VolumeInfo volume = PatternSource::info_of(before.size, {1, 1, 1});
        const OperationResult result = run(FillBetweenOp{.group = 1}, {.mask = mask, .volume = volume});
        apply(mask, result.changes);
        const auto parts = reference::components_of(
            dense_of(mask), [](uint8_t group) { return group == 1; }, 6);
        CHECK(parts.size() == (apart < 6 ? 1 : 2));
        CHECK(result.note == "the group has 2 painted slices with 1 gap between them");
    }
}

TEST_CASE("filling between slices costs the painted bricks and its result, not the volume, within the budget")
{
    const Size3 size(int64_t{1} << 20);
    Mask mask(size);
    const VolumeInfo volume = PatternSource::info_of(size, {1, 1, 1});
    const auto add = [&](const Size3& at) {
        const auto index = uint16_t(index_in_brick(at));
        mask.apply({.brick = index_of(at / BRICK_SIDE, mask.brick_counts()), .runs = {{index, index, 0, 1}}},
                   Direction::forwards);
    };
    add({700'007, 5, 900'000});
    add({700'007, 5, 900'320});
    const OperationResult result = run(FillBetweenOp{.group = 1}, {.mask = mask, .volume = volume});
    CHECK(result.voxels == 319);
    CHECK(result.bricks_written == 10);
    CHECK(result.bricks_read == 2 + 2 + 10);
    add({5, 700'007, 900'320});
    CHECK_THROWS_WITH_AS(
        static_cast<void>(run(FillBetweenOp{.group = 1}, {.mask = mask, .volume = volume, .memory = 64 << 20})),
        doctest::Contains("MiB of memory; expected at most 64 MiB, the budget of the host"), Error);
}

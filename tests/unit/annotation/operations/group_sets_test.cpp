// Operations on groups as sets of voxels: combining, islands, holes; against tests/reference/group_operations.h.

#include "engine/base/text.h"
#include "tests/unit/annotation/operations/operation_cases.h"

using namespace shvr;
using namespace shvr::test;

namespace {

using How = CombineOp::How;
using Keep = IslandsOp::Keep;

/// Returns the message of the failure of an operation; empty if it does not fail.
std::string failure_of(const GroupOperation& operation, const DenseGroups& before, const std::string& unit = "mm")
{
    const Mask mask = mask_of(before);
    VolumeInfo volume = PatternSource::info_of(before.size, {1, 1, 1});
    volume.unit = unit;
    try {
        static_cast<void>(run(operation, {.mask = mask, .volume = volume}));
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

DenseGroups empty_groups(const Size3& size)
{
    return {size, std::vector<uint8_t>(size_t(size.x * size.y * size.z))};
}

void paint_box(DenseGroups& dense, const Size3& lower, const Size3& upper, uint8_t group)
{
    reference::for_each_voxel(upper - lower, [&](const Size3& step) { dense.at(lower + step) = group; });
}

}  // namespace

// Kind (operations on groups): limits and locks, borders of bricks and of the volume
TEST_CASE("operations on groups agree with their definitions, whatever limits and locks")
{
    std::mt19937 random(5);
    for (const Size3& size : ODD_SIZES) {
        const DenseGroups before = random_groups(random, size);
        const auto with_limits = [&](auto op) {
            for (int i = 0; i < 3; ++i) {
                op.limits = i == 0 ? OperationLimits{} : random_limits(random, size);
                GroupSet locked;
                if (i == 2) locked[1 + random() % 4] = true;
                check_operation(op, before, {0.5, 0.5, 1.25}, locked);
            }
        };
        for (const How how : {How::add, How::subtract, How::intersect, How::copy, How::move, How::swap})
            with_limits(CombineOp{.group = 1, .with = 3, .how = how});
        for (const int64_t connectivity : {6, 26}) {
            with_limits(IslandsOp{.group = 2, .keep = Keep::largest, .split_from = {}, .connectivity = connectivity});
            with_limits(IslandsOp{
                .group = 3, .keep = Keep::at_least, .voxels = 4, .split_from = {}, .connectivity = connectivity});
            with_limits(
                IslandsOp{.group = 1, .keep = Keep::at_least, .mm3 = 2.5, .split_from = 20, .connectivity = 26});
        }
        with_limits(ThresholdOp{.group = 2, .from = 60.0, .to = 200.0});
        with_limits(ThresholdOp{.group = 3, .to = 77.0});
        with_limits(ThresholdOp{.group = 2, .from = 59.5, .to = 60.5});
        with_limits(ThresholdOp{.group = 2, .from = 59.25, .to = 59.75});
        with_limits(ThresholdOp{.group = 2, .from = 249.5, .to = 300.0});
        with_limits(FillHolesOp{.group = 1});
        with_limits(FillHolesOp{.group = 4});
    }
}

TEST_CASE("a box without voxels of the volume is refused")
{
    DenseGroups dense = empty_groups({20, 20, 20});
    dense.at({3, 3, 3}) = 1;
    const auto refused = [&](const VoxelBox& box) {
        return failure_of(FillHolesOp{.group = 1, .limits = {.box = box}}, dense);
    };
    CHECK(refused({{0, 0, 20}, {5, 5, 25}}) ==
          "key box is [0,0,20,5,5,25]; expected a box that has voxels of the volume, which has 20 x 20 x 20");
    CHECK_FALSE(refused({{-5, 0, 0}, {0, 5, 5}}).empty());
    CHECK(refused({{-5, 0, 19}, {1, 5, 99}}).empty());
}

TEST_CASE("islands are joined over faces only, or over edges and corners, across borders of bricks")
{
    DenseGroups before = empty_groups({66, 66, 66});
    for (const Size3& corner : {Size3(31, 31, 31), Size3(32, 32, 32), Size3(31, 33, 33), Size3(32, 31, 31),
                                Size3(30, 32, 64), Size3(31, 31, 63), Size3(32, 32, 62)})
        before.at(corner) = 1;
    for (const int64_t connectivity : {6, 26}) {
        const OperationResult result = check_operation(
            IslandsOp{.group = 1, .keep = Keep::all, .split_from = 5, .connectivity = connectivity}, before);
        CHECK(result.note == (connectivity == 6 ? "6 parts, 6 kept" : "2 parts, 2 kept"));
    }
    check_operation(IslandsOp{.group = 1, .keep = Keep::at, .at = glm::dvec3(32.9, 31.0, 31.5), .split_from = {}},
                    before);
}

TEST_CASE("holes larger than bricks are filled, and tunnels are none")
{
    DenseGroups before = empty_groups({100, 99, 101});
    paint_box(before, {3, 2, 5}, {98, 97, 98}, 2);
    paint_box(before, {5, 4, 7}, {96, 95, 96}, 0);     // inside are whole bricks without paint
    paint_box(before, {66, 66, 66}, {90, 75, 75}, 2);  // a solid part in it, with a cavity of its own
    paint_box(before, {68, 69, 69}, {80, 72, 72}, 3);
    int64_t holes = 2;
    SUBCASE("closed") {}
    SUBCASE("a tunnel of one voxel")
    {
        before.at({50, 2, 50}) = before.at({50, 3, 50}) = 0;
        holes = 1;
    }
    SUBCASE("a slit over an edge only is no way out")
    {
        before.at({3, 2, 50}) = before.at({4, 3, 50}) = 0;  // the second is a hole of its own
        holes = 3;
    }
    CHECK(check_operation(FillHolesOp{.group = 2}, before).note == counted(holes, "hole"));
}

TEST_CASE("operations on groups cost what is painted, not the volume")
{
    const Size3 size(1 << 20, 1 << 20, 1 << 20);
    Mask mask(size);
    const VolumeInfo volume = PatternSource::info_of(size, {1, 1, 1});
    // A shell around one voxel, far from the origin, and a lone voxel at the volume's last corner.
    const Size3 at(700'000, 900'001, 31);
    std::map<int64_t, MaskBrick> bricks;
    const auto paint = [&](const Size3& voxel) {
        bricks[index_of(voxel / BRICK_SIDE, mask.brick_counts())][index_in_brick(voxel)] = 1;
    };
    for (int axis = 0; axis < 3; ++axis)
        for (const int64_t step : {-1, 1}) {
            Size3 voxel = at;
            voxel[axis] += step;
            paint(voxel);
        }
    paint(size - int64_t{1});
    for (const auto& [brick, groups] : bricks) {
        MaskBrickChange change{.brick = brick, .runs = {}};
        append_painted_runs(change.runs, groups, 0);
        mask.apply(change, Direction::forwards);
    }
    const OperationInput input{.mask = mask, .volume = volume};
    OperationResult result = run(FillHolesOp{.group = 1}, input);
    CHECK(result.voxels == 1);
    CHECK(result.bricks_read == int64_t(bricks.size()) + 1);
    CHECK(result.bricks_written == 1);
    result =
        run(IslandsOp{.group = 1, .keep = Keep::at_least, .voxels = 2, .split_from = {}, .connectivity = 26}, input);
    CHECK(result.voxels == 1);
    CHECK(result.bricks_written == 1);
    CHECK(result.bricks_read == 2 * int64_t(bricks.size()));
    const VoxelBox box{at - int64_t{2}, at};
    result = run(CombineOp{.group = 2, .with = 1, .how = How::add, .limits = {.box = box}}, input);
    CHECK(result.bricks_read == 1);
    CHECK(result.bricks_of_intensities == 0);
}

TEST_CASE("operations state why they are not possible, and what they did")
{
    DenseGroups before = empty_groups({40, 8, 8});
    paint_box(before, {0, 0, 0}, {4, 4, 4}, 3);
    for (const int64_t x : {10, 20, 30}) before.at({x, 1, 1}) = 3;
    before.at({35, 5, 5}) = 9;
    CHECK(failure_of(IslandsOp{.group = 3, .keep = Keep::at, .at = glm::dvec3(5, 5, 5), .split_from = {}}, before) ==
          "key at is [5,5,5], where no voxel of group 3 is; expected a position in it");
    CHECK(failure_of(IslandsOp{.group = 3, .keep = Keep::all, .split_from = 253}, before) ==
          "group 3 has 4 parts to split from group 253 on; expected at most 3: keep those of at least some size "
          "(at_least)");
    CHECK(failure_of(IslandsOp{.group = 3, .keep = Keep::all, .split_from = 7}, before) ==
          "key split_from is 7, and group 9 has 1 voxels already; expected 4 groups without voxels from there on");
    CHECK(failure_of(IslandsOp{.group = 3, .keep = Keep::at_least, .mm3 = 3.0, .split_from = {}}, before, "voxel") ==
          "key mm3 is 3, and the volume's unit is \"voxel\"; expected a unit of length (--spacing, --unit), or voxels "
          "instead");
    CHECK(failure_of(CombineOp{.group = 3, .with = 9, .limits = {.within = glm::dvec2(0, 9)}}, before) ==
          "the operation needs intensities, and there are none here");
    GroupSet locked;
    locked[9] = true;
    const OperationResult result =
        check_operation(CombineOp{.group = 3, .with = 9, .how = How::swap}, before, {1, 1, 1}, locked);
    CHECK(sentence_of(result, "Combine groups", {}) ==
          "Combine groups: nothing changed; group 9 is locked, so 68 voxels stayed");
    CHECK(sentence_of(check_operation(IslandsOp{.group = 3, .keep = Keep::largest, .split_from = {}}, before),
                      "Islands", {.name_of = [](uint8_t) { return std::string("wood"); }}) ==
          "Islands: 3 voxels of group 3 (wood) erased; 4 parts, 1 kept");
    CHECK(sentence_of(result, "Combine groups", {.is_preview = true}) ==
          "Combine groups: nothing would change; group 9 is locked, so 68 voxels would stay");
    int calls = 0;
    const Mask mask = mask_of(before);
    const VolumeInfo volume = PatternSource::info_of(before.size, {1, 1, 1});
    const auto stop = [&](double) {
        if (++calls == 2) throw Stopped("stopped");
    };
    CHECK_THROWS_AS(static_cast<void>(run(FillHolesOp{.group = 3}, {.mask = mask, .volume = volume}, stop)), Stopped);
}

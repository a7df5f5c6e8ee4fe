// Smoothing of groups; against tests/reference/group_operations.h.

#include <cmath>

#include "tests/unit/annotation/operations/operation_cases.h"

using namespace shvr;
using namespace shvr::test;

using Method = SmoothOp::Method;

// Kind (operations on groups): kernels that whole voxels reach exactly, anisotropic spacing, borders of bricks
TEST_CASE("smoothing agrees with its definition")
{
    std::mt19937 random(5);
    const Size3 sizes[] = {{33, 31, 1}, {32, 34, 5}, {66, 9, 7}, {9, 7, 34}};
    const glm::dvec3 spacings[] = {{1, 1, 1}, {0.1, 0.3, 0.2}, {2, 0.7, 1.1}, {3e-7, 2e-7, 2e-7}};
    for (size_t i = 0; i < std::size(sizes); ++i) {
        const DenseGroups before = random_groups(random, sizes[i]);
        for (const double voxels : {0.9, 1.0, 2.0})
            for (const Method method : {Method::median, Method::gaussian}) {
                CAPTURE(i);
                CAPTURE(voxels);
                SmoothOp op{.distance = voxels * spacings[i].x, .method = method};
                check_operation(op, before, spacings[i]);
                op.groups = {uint8_t(1 + random() % 2), uint8_t(3 + random() % 2)};
                op.limits = random_limits(random, sizes[i]);
                GroupSet locked;
                locked[1 + random() % 4] = true;
                check_operation(op, before, spacings[i], locked);
            }
    }
}

TEST_CASE("smoothing between two groups that touch leaves no gap and brings no third group")
{
    std::mt19937 random(8);
    DenseGroups before{{40, 36, 9}, std::vector<uint8_t>(40 * 36 * 9)};
    for (uint8_t& voxel : before.groups) voxel = random() % 2 == 0 ? 3 : 200;
    for (const Method method : {Method::median, Method::gaussian}) {
        const OperationResult result = check_operation(SmoothOp{.distance = 2.0, .method = method}, before);
        CHECK(result.voxels > 1000);
        for (const auto& [groups, voxels] : result.moved) CHECK(((groups.second == 3) || (groups.second == 200)));
    }
}

TEST_CASE("smoothing costs the surroundings of the groups, not the volume, and its kernel is bounded")
{
    const Size3 size(1 << 20, 1 << 20, 1 << 20);
    Mask mask(size);
    const VolumeInfo volume = PatternSource::info_of(size, {1, 1, 1});
    const Size3 at(1'000'016, 500'016, 16);
    mask.apply({.brick = index_of(at / BRICK_SIDE, mask.brick_counts()),
                .runs = {{uint16_t(index_in_brick(at)), uint16_t(index_in_brick(at)), 0, 1}}},
               Direction::forwards);
    const OperationInput input{.mask = mask, .volume = volume};
    const OperationResult result = run(SmoothOp{.distance = 1.0}, input);
    CHECK(result.voxels == 1);
    CHECK(result.bricks_written == 1);
    CHECK(result.bricks_read ==
          9 * 18 + 9 * 27 + 1);  // bricks around each of two layers of nine; the changed one again
    std::string failure;
    try {
        static_cast<void>(run(SmoothOp{.distance = 40.0}, input));
    } catch (const Error& error) {
        failure = error.what();
    }
    CHECK(failure == "the distance is 40, 40 voxels along x; expected at most 32 voxels");
}

TEST_CASE("a cube of three voxels loses its corners, unless another group is smoothed")
{
    DenseGroups before{{9, 9, 9}, std::vector<uint8_t>(9 * 9 * 9)};
    reference::for_each_voxel(Size3(3), [&](const Size3& step) { before.at(step + int64_t{2}) = 7; });
    CHECK(check_operation(SmoothOp{.distance = 1.5}, before).voxels == 8);
    CHECK(check_operation(SmoothOp{.groups = {6, 7}, .distance = 1.5}, before).voxels == 8);
    CHECK(check_operation(SmoothOp{.groups = {6}, .distance = 1.5}, before).voxels == 0);
}

// Kind (operations on groups): every group within one kernel's reach
TEST_CASE("smoothing agrees with its definition where all 255 groups meet")
{
    std::mt19937 random(21);
    DenseGroups before{{34, 9, 5}, std::vector<uint8_t>(34 * 9 * 5)};
    for (uint8_t& voxel : before.groups) voxel = uint8_t(random() % 256);
    for (const Method method : {Method::median, Method::gaussian})
        CHECK(check_operation(SmoothOp{.distance = 1.5, .method = method}, before).voxels > 0);
}

// Kind (operations on groups): kernels with more voxels than 16 bits count, and rows longer than a brick
TEST_CASE("medians by the largest kernel agree with their definition, in the middle and at borders")
{
    std::mt19937 random(9);
    const Size3 size(97, 40, 42);
    DenseGroups before = random_groups(random, size, 40);
    for (uint8_t& group : before.groups)
        if (group == 0 && random() % 4 != 0) group = 9;
    const int64_t reach = 32;
    Mask mask = mask_of(before);
    const VolumeInfo volume = PatternSource::info_of(size, {1, 1, 1});
    const OperationResult result = run(SmoothOp{.distance = double(reach)}, {.mask = mask, .volume = volume});
    CHECK(result.voxels > 1000);
    apply(mask, result.changes);
    int moved = 0;
    for (int i = 0; i < 40; ++i) {
        Size3 voxel(int64_t(random() % 97), int64_t(random() % 40), int64_t(random() % 42));
        if (i < 8) voxel = {i % 2 * 96, i / 2 % 2 * 39, i / 4 * 41};
        std::array<int64_t, 256> counts{};
        const Size3 lower = glm::max(voxel - reach, Size3(0)), upper = glm::min(voxel + reach + int64_t{1}, size);
        reference::for_each_voxel(upper - lower, [&](const Size3& step) {
            const Size3 away = lower + step - voxel;
            if (away.x * away.x + away.y * away.y + away.z * away.z <= reach * reach) ++counts[before.at(lower + step)];
        });
        const auto most = std::ranges::max_element(counts);
        const uint8_t own = before.at(voxel);
        const uint8_t winner = counts[own] == *most ? own : uint8_t(most - counts.begin());
        CHECK(mask.at(voxel) == winner);
        moved += winner != own;
    }
    CHECK(moved > 3);
}

// Kind (operations on groups): the largest sums of weights
TEST_CASE("Gaussians by the largest kernel agree with their definition, in the middle and at borders")
{
    std::mt19937 random(10);
    const Size3 size(97, 70, 66);
    DenseGroups before{size, std::vector<uint8_t>(size_t(97 * 70 * 66))};
    for (size_t i = 0; i < before.groups.size(); ++i)  // a half space that is nearly full, with a rough border
        before.groups[i] = uint8_t(int64_t(i) % 97 < 40 + int64_t(random() % 16) ? 3 : 0);
    const int64_t reach = 32;
    const double distance = 32.9;
    Mask mask = mask_of(before);
    const VolumeInfo volume = PatternSource::info_of(size, {1, 1, 1});
    const OperationResult result =
        run(SmoothOp{.distance = distance, .method = Method::gaussian}, {.mask = mask, .volume = volume});
    CHECK(result.voxels > 1000);
    apply(mask, result.changes);
    std::vector<uint64_t> along;
    for (int64_t i = 0; i <= reach; ++i) {
        const double sigmas = double(i) / (0.5 * distance);
        along.push_back(uint64_t(std::llround(1024.0 * std::exp(-0.5 * sigmas * sigmas))));
    }
    int moved = 0;
    for (int i = 0; i < 24; ++i) {
        Size3 voxel(int64_t(40 + random() % 16), int64_t(random() % 70), int64_t(random() % 66));
        if (i < 8) voxel = {i % 2 * 96, i / 2 % 2 * 69, i / 4 * 65};
        std::array<uint64_t, 4> weights{};
        const Size3 lower = glm::max(voxel - reach, Size3(0)), upper = glm::min(voxel + reach + int64_t{1}, size);
        reference::for_each_voxel(upper - lower, [&](const Size3& step) {
            const Size3 away = glm::abs(lower + step - voxel);
            weights[before.at(lower + step)] += along[size_t(away.x)] * along[size_t(away.y)] * along[size_t(away.z)];
        });
        const uint8_t own = before.at(voxel), winner = weights[0] == weights[3] ? own : weights[0] > weights[3] ? 0 : 3;
        CHECK(mask.at(voxel) == winner);
        moved += winner != own;
    }
    CHECK(moved > 3);
}

// Which of the voxels that a brush selects it may change: against the definition, voxel by voxel, on random masks.

#include "engine/annotation/painting.h"

#include <random>

#include <doctest/doctest.h>

#include "engine/annotation/stroke_result.h"

using namespace shvr;

namespace {

template <class Visit>
void for_each_voxel(const Size3& size, const Visit& visit)
{
    for (int64_t z = 0; z < size.z; ++z)
        for (int64_t y = 0; y < size.y; ++y)
            for (int64_t x = 0; x < size.x; ++x) visit(Size3(x, y, z));
}

VoxelSelection random_selection(std::mt19937& random, const Size3& size)
{
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    const glm::dvec3 centre(uniform(-2, double(size.x) + 2), uniform(-2, double(size.y) + 2),
                            uniform(-2, double(size.z) + 2));
    const auto shape = random() % 2 == 0 ? RegionShape::ball : RegionShape::box;
    const BrushRegion region = make_region(shape, centre, uniform(2.0, 25.0), {1, 1, 1.25}, size);
    std::vector<uint32_t> words(size_t(region.words_per_row()) * region.rows.size());
    const bool is_full = random() % 2 == 0;
    for (uint32_t& word : words) word = is_full ? ~0u : uint32_t(random());
    VoxelSelection selection(size);
    if (!region.rows.empty()) selection.add(region, words);
    return selection;
}

std::vector<uint8_t> groups_of(const Mask& mask)
{
    std::vector<uint8_t> groups;
    for_each_voxel(mask.size(), [&](const Size3& voxel) { groups.push_back(mask.at(voxel)); });
    return groups;
}

void take(Mask& mask, const std::vector<MaskBrickChange>& changes, Direction direction = Direction::forwards)
{
    for (const MaskBrickChange& change : changes) mask.apply(change, direction);
}

/// Some voxels in each of the groups 1 ... 4.
Mask random_mask(std::mt19937& random, const Size3& size)
{
    Mask mask(size);
    for (int i = 0; i < 6; ++i)
        take(mask, paint_changes(mask, random_selection(random, size), {uint8_t(random() % 5)}));
    return mask;
}

PaintOp random_op(std::mt19937& random)
{
    PaintOp op{.group = uint8_t(random() % 5), .only_unpainted = random() % 3 == 0};
    for (size_t group = 1; group < 5; ++group) op.locked[group] = random() % 3 == 0;
    return op;
}

/// The rule once more, by what must hold of a stroke.
struct Expected {
    StrokeResult result;
    std::vector<uint8_t> groups;
};
Expected expected_of(const PaintOp& op, const std::vector<uint8_t>& before, const Size3& size,
                     const std::vector<VoxelSelection>& selections)
{
    Expected expected{.result = {.stroke = op}, .groups = before};
    size_t at = 0;
    for_each_voxel(size, [&](const Size3& voxel) {
        const uint8_t group = before[at];
        uint8_t& after = expected.groups[at++];
        const bool is_selected = std::ranges::any_of(selections, [&](const auto& one) { return one.contains(voxel); });
        if (!is_selected || group == op.group) return;
        if (group != 0 && op.locked[group]) {
            ++expected.result.kept_locked[group];
        } else if (op.group != 0 && op.locked[op.group]) {
            ++expected.result.kept_locked_out;
        } else if (op.only_unpainted && group != 0) {
            ++expected.result.kept_painted;
        } else {
            after = op.group;
            ++expected.result.regrouped;
            if (group != 0) ++expected.result.taken_from[group];
        }
    });
    return expected;
}

}  // namespace

TEST_CASE("locked groups lose and gain no voxel, and a brush held to unpainted voxels takes none, on 200 random masks")
{
    int64_t changed = 0, kept_locked = 0, kept_out = 0, kept_painted = 0;
    for (uint32_t seed = 0; seed < 200; ++seed) {
        CAPTURE(seed);
        std::mt19937 random(seed);
        const Size3 size(1 + random() % 70, 1 + random() % 40, 1 + random() % 40);
        Mask mask = random_mask(random, size);
        const PaintOp op = random_op(random);
        const std::vector<uint8_t> before = groups_of(mask);
        const VoxelSelection selection = random_selection(random, size);
        const Expected expected = expected_of(op, before, size, {selection});

        const std::vector<MaskBrickChange> changes = paint_changes(mask, selection, rule_of(op));
        StrokeTally tally(op);
        tally.add(mask, selection, changes, {});
        CHECK((tally.result() == expected.result));
        take(mask, changes);
        CHECK((groups_of(mask) == expected.groups));
        CHECK(paint_changes(mask, selection, rule_of(op)).empty());
        for (const MaskBrickChange& change : changes) {
            CHECK_FALSE(change.runs.empty());
            for (size_t i = 1; i < change.runs.size(); ++i)  // the fewest runs
                CHECK_FALSE((change.runs[i - 1].last + 1 == change.runs[i].first &&
                             change.runs[i - 1].before == change.runs[i].before));
        }
        take(mask, {changes.rbegin(), changes.rend()}, Direction::backwards);  // whatever is locked
        CHECK((groups_of(mask) == before));
        changed += expected.result.regrouped;
        kept_locked += expected.result.kept_by_locks();
        kept_out += expected.result.kept_locked_out;
        kept_painted += expected.result.kept_painted;
    }
    for (const int64_t voxels : {changed, kept_locked, kept_out, kept_painted}) CHECK(voxels > 5'000);
}

TEST_CASE("a stroke of many answers that overlap counts each voxel once, as if all had come at once")
{
    for (uint32_t seed = 0; seed < 100; ++seed) {
        CAPTURE(seed);
        std::mt19937 random(seed);
        const Size3 size(1 + random() % 70, 1 + random() % 40, 1 + random() % 40);
        Mask mask = random_mask(random, size);
        PaintOp op = random_op(random);
        op.path = {{1, 2, 3}};
        const std::vector<uint8_t> before = groups_of(mask);
        std::vector<VoxelSelection> selections;
        StrokeTally tally(op);
        for (int answer = 0; answer < 5; ++answer) {
            selections.push_back(random_selection(random, size));
            const std::vector<MaskBrickChange> changes = paint_changes(mask, selections.back(), rule_of(op));
            tally.add(mask, selections.back(), changes, {});
            take(mask, changes);
        }
        op.path.clear();
        const Expected expected = expected_of(op, before, size, selections);
        CHECK((tally.result() == expected.result));
        CHECK((groups_of(mask) == expected.groups));
    }
}

TEST_CASE("a voxel that one stroke raises twice counts once, and locks have no say about offsets")
{
    const Mask mask({40, 40, 40});
    const VoxelSelection nothing(mask.size());
    PaintOp op{.group = 3, .density = DensityBrush{20.0}, .paints_group = false};
    op.locked.set().reset(0);
    StrokeTally tally(op);
    const DensityBrickChange first[] = {{.brick = 0, .runs = {{10, 19, 0, 5}}}, {.brick = 1, .runs = {{0, 0, 0, 5}}}};
    const DensityBrickChange second[] = {{.brick = 0, .runs = {{15, 15, 5, 9}, {16, 24, 5, 7}}}};
    tally.add(mask, nothing, {}, first);
    CHECK(tally.result().raised == 11);
    tally.add(mask, nothing, {}, second);
    CHECK(tally.result().raised == 16);
    CHECK(tally.result().voxels() == 16);
    CHECK(tally.result().kept_by_locks() == 0);
}

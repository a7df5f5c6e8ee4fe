// Connected parts of a group: decides which parts stay, and which group each part gets.

#include <algorithm>
#include <unordered_map>

#include "engine/annotation/operations/group_bricks.h"
#include "engine/annotation/operations/run_operation.h"
#include "engine/annotation/sets/brick_components.h"
#include "engine/base/text.h"
#include "engine/volume/unit.h"

namespace shvr {

namespace {

struct Island {
    uint32_t root = 0;
    int64_t voxels = 0;
    Size3 first{0};  ///< the first voxel in the order of z, then y, then x
};

bool is_before(const Size3& a, const Size3& b)
{
    return std::tie(a.z, a.y, a.x) < std::tie(b.z, b.y, b.x);
}

BrickComponents components_of(const IslandsOp& op, MaskEdit& edit, const Progress& progress)
{
    BrickComponents components(edit.mask().brick_counts(), op.connectivity);
    for_each_brick(edit.mask(), progress, [&](int64_t brick) {
        const BrickBits bits = bits_of(edit.read(brick), uint8_t(op.group));
        if (!is_empty(bits)) components.add(brick, bits);
    });
    return components;
}

template <class Visit>
void for_each_run(const BrickComponents& components, int64_t brick, const Visit& visit)
{
    for (size_t row = 0; row < std::tuple_size_v<BrickBits>; ++row)
        for (const BrickComponents::Run& run : components.runs(brick, row)) visit(row, run);
}

/// The islands, largest first; islands of equal size are sorted by their first voxels.
std::vector<Island> islands_in(BrickComponents& components, const Mask& mask)
{
    std::unordered_map<uint32_t, Island> found;
    for (const int64_t brick : components.bricks()) {
        const Size3 corner = mask.box_of(brick).lower;
        for_each_run(components, brick, [&](size_t row, const BrickComponents::Run& run) {
            const uint32_t root = components.root_of(run.label);
            const Size3 first = corner + Size3(run.first, int64_t(row) % BRICK_SIDE, int64_t(row) / BRICK_SIDE);
            Island& island = found.try_emplace(root, Island{root, 0, first}).first->second;
            island.voxels += run.last - run.first + 1;
            if (is_before(first, island.first)) island.first = first;
        });
    }
    std::vector<Island> islands;
    for (const auto& [root, island] : found) islands.push_back(island);
    std::ranges::sort(islands, [](const Island& a, const Island& b) {
        return a.voxels != b.voxels ? a.voxels > b.voxels : is_before(a.first, b.first);
    });
    return islands;
}

/// The smallest number of voxels to keep.
int64_t fewest_voxels(const IslandsOp& op, const VolumeInfo& volume)
{
    if (op.voxels) return *op.voxels;
    const std::optional<double> micrometres = micrometres_in(volume.unit);
    if (!micrometres)
        fail("key mm3 is ", *op.mm3, ", and the volume's unit is ", in_quotes(volume.unit),
             "; expected a unit of length (--spacing, --unit), or voxels instead");
    const glm::dvec3 side = volume.spacing * (*micrometres / 1000.0);
    const double voxels = *op.mm3 / (side.x * side.y * side.z);
    // Tolerates the rounding of the quotient, so that a part of exactly `mm3` stays.
    return int64_t(std::min(std::ceil(voxels * (1.0 - 1e-12)), 9e18));
}

uint32_t root_at(BrickComponents& components, const IslandsOp& op, const Mask& mask)
{
    const Size3 voxel(glm::floor(*op.at));
    if (glm::all(glm::greaterThanEqual(voxel, Size3(0))) && glm::all(glm::lessThan(voxel, mask.size()))) {
        const int64_t brick = index_of(voxel / BRICK_SIDE, mask.brick_counts());
        const Size3 in_brick = voxel % BRICK_SIDE;
        if (components.has(brick))
            for (const BrickComponents::Run& run : components.runs(brick, size_t(in_brick.y + 32 * in_brick.z)))
                if (run.first <= in_brick.x && in_brick.x <= run.last) return components.root_of(run.label);
    }
    fail("key at is [", op.at->x, ',', op.at->y, ',', op.at->z, "], where no voxel of group ", op.group,
         " is; expected a position in it");
}

/// The new group of each island, by the island's root label; 0: erased.
std::unordered_map<uint32_t, uint8_t> groups_of(const IslandsOp& op, BrickComponents& components,
                                                const std::vector<Island>& islands, const MaskEdit& edit)
{
    const int64_t fewest = op.keep == IslandsOp::Keep::at_least ? fewest_voxels(op, edit.input().volume) : 0;
    const uint32_t root = op.keep == IslandsOp::Keep::at ? root_at(components, op, edit.mask()) : 0;
    std::vector<const Island*> kept;
    for (const Island& island : islands)
        if (op.keep == IslandsOp::Keep::at        ? island.root == root
            : op.keep == IslandsOp::Keep::largest ? kept.empty()
                                                  : island.voxels >= fewest)
            kept.push_back(&island);
    std::unordered_map<uint32_t, uint8_t> groups;
    for (const Island& island : islands) groups[island.root] = 0;
    for (size_t i = 0; i < kept.size(); ++i)
        groups[kept[i]->root] = uint8_t(op.split_from ? *op.split_from + int64_t(i) : op.group);
    if (!op.split_from) return groups;
    if (*op.split_from + int64_t(kept.size()) > 256)
        fail("group ", op.group, " has ", kept.size(), " parts to split from group ", *op.split_from,
             " on; expected at most ", 256 - *op.split_from, ": keep those of at least some size (at_least)");
    for (size_t i = 0; i < kept.size(); ++i) {
        const size_t group = size_t(*op.split_from) + i;
        const int64_t there = edit.mask().voxels_by_group()[group];
        if (there > 0 && int64_t(group) != op.group)
            fail("key split_from is ", *op.split_from, ", and group ", group, " has ", there,
                 " voxels already; expected ", kept.size(), " groups without voxels from there on");
    }
    return groups;
}

}  // namespace

void perform(const IslandsOp& op, MaskEdit& edit, const Progress& progress)
{
    BrickComponents components = components_of(op, edit, part_of(progress, 0.0, 0.6));
    const std::vector<Island> islands = islands_in(components, edit.mask());
    const std::unordered_map<uint32_t, uint8_t> groups = groups_of(op, components, islands, edit);
    const auto kept = std::ranges::count_if(groups, [](const auto& each) { return each.second != 0; });
    edit.note(sentence(counted(int64_t(islands.size()), "part"), ", ", kept, " kept"));
    for_each_brick(components.bricks(), part_of(progress, 0.6, 1.0), [&](int64_t brick) {
        if (!edit.may_change(brick)) return;
        MaskBrick wanted = edit.read(brick);
        for_each_run(components, brick, [&](size_t row, const BrickComponents::Run& run) {
            const uint8_t group = groups.at(components.root_of(run.label));
            std::fill(wanted.begin() + int64_t(32 * row + run.first), wanted.begin() + int64_t(32 * row + run.last + 1),
                      group);
        });
        edit.want(brick, wanted);
    });
}

}  // namespace shvr

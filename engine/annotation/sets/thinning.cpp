#include "engine/annotation/sets/thinning.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace shvr {

namespace {

constexpr int MIDDLE = 13;
using Masks = std::array<uint32_t, 27>;

constexpr int steps_between(int a, int b, bool is_sum)
{
    const auto size = [](int of) { return of < 0 ? -of : of; };
    const int x = size(a % 3 - b % 3), y = size(a / 3 % 3 - b / 3 % 3), z = size(a / 9 - b / 9);
    return is_sum ? x + y + z : std::max({x, y, z});
}
/// For each of the 3 x 3 x 3 places, a bit set of its neighbours: over faces only (6), or over edges and corners too.
constexpr Masks neighbours(bool over_faces)
{
    Masks masks{};
    for (int a = 0; a < 27; ++a)
        for (int b = 0; b < 27; ++b)
            if (a != b && steps_between(a, b, over_faces) == 1) masks[size_t(a)] |= 1u << b;
    return masks;
}
constexpr Masks OVER_FACES = neighbours(true), OVER_ALL = neighbours(false);
constexpr uint32_t corners()
{
    uint32_t mask = 0;
    for (int a = 0; a < 27; ++a)
        if (steps_between(a, MIDDLE, true) == 3) mask |= 1u << a;
    return mask;
}
constexpr uint32_t ALL = (1u << 27) - 1, AROUND = ALL & ~(1u << MIDDLE), FACES_AND_EDGES = AROUND & ~corners();

/// The connected part of `set` that contains the place `start`.
uint32_t part_of_set(uint32_t set, uint32_t start, const Masks& neighbours)
{
    uint32_t part = start;
    for (uint32_t left = start; left != 0;) {
        const uint32_t found = neighbours[size_t(std::countr_zero(left))] & set & ~part;
        left = (left & (left - 1)) | found;
        part |= found;
    }
    return part;
}
uint32_t lowest(uint32_t set)
{
    return set & (~set + 1u);
}

/// A set from which voxels are taken.
class Remaining {
public:
    Remaining(BrickSet set, const Mask& mask) : set_(std::move(set)), size_(mask.size()), counts_(mask.brick_counts())
    {}
    bool has(const Size3& voxel)
    {
        if (glm::any(glm::lessThan(voxel, Size3(0))) || glm::any(glm::greaterThanEqual(voxel, size_))) return false;
        const BrickBits* const bits = brick_of(voxel);
        return bits && ((*bits)[row_of(voxel)] >> (voxel.x % BRICK_SIDE) & 1u) != 0;
    }
    void remove(const Size3& voxel) { (*brick_of(voxel))[row_of(voxel)] &= ~(1u << (voxel.x % BRICK_SIDE)); }
    uint32_t around(const Size3& voxel);
    BrickSet take() { return std::move(set_); }

private:
    static size_t row_of(const Size3& voxel)
    {
        return size_t(voxel.y % BRICK_SIDE + BRICK_SIDE * (voxel.z % BRICK_SIDE));
    }
    BrickBits* brick_of(const Size3& voxel)
    {
        const int64_t brick = index_of(voxel / BRICK_SIDE, counts_);
        if (brick != last_) {
            const auto found = set_.find(brick);
            bits_ = found == set_.end() ? nullptr : &found->second;
            last_ = brick;
        }
        return bits_;
    }
    BrickSet set_;
    Size3 size_, counts_;
    int64_t last_ = -1;
    BrickBits* bits_ = nullptr;
};

uint32_t Remaining::around(const Size3& voxel)
{
    uint32_t bits = 0;
    const Size3 in_brick = voxel % BRICK_SIDE;
    const bool is_inside =
        glm::all(glm::greaterThan(in_brick, Size3(0))) && glm::all(glm::lessThan(in_brick, Size3(BRICK_SIDE - 1)));
    for (int row = 0; row < 9; ++row) {
        const Size3 first = voxel + Size3(-1, row % 3 - 1, row / 3 - 1);
        if (is_inside) {
            bits |= ((*brick_of(voxel))[row_of(first)] >> first.x % BRICK_SIDE & 7u) << (3 * row);
            continue;
        }
        for (int x = 0; x < 3; ++x) bits |= uint32_t(has(first + Size3(x, 0, 0))) << (3 * row + x);
    }
    return bits;
}

class Thinning {
public:
    Thinning(const BrickSet& set, const Reach& reach) : size_(reach.mask.size()), remaining_(set, reach.mask) {}
    /// Removes all removable voxels among `voxels`, then repeatedly among the neighbours of removed voxels that are in
    /// `may_go`. Meanwhile, reports `done` as the completed fraction.
    void remove(std::vector<int64_t> voxels, Remaining& may_go, const Progress& progress, double done);
    BrickSet take() { return remaining_.take(); }

private:
    bool can_go(uint32_t around) const { return std::popcount(around & AROUND) > 1 && is_simple_point(around); }
    void remove_from(int direction, std::span<const int64_t> voxels, Remaining& may_go, std::vector<int64_t>& next);

    Size3 size_;
    Remaining remaining_;
};

void Thinning::remove_from(int direction, std::span<const int64_t> voxels, Remaining& may_go,
                           std::vector<int64_t>& next)
{
    static constexpr std::array<uint32_t, 6> TOWARDS{1u << 4, 1u << 22, 1u << 10, 1u << 16, 1u << 12, 1u << 14};
    std::array<std::vector<int64_t>, 8> border;  // by parities of x, y and z
    for (const int64_t index : voxels) {
        const Size3 voxel = position_of(index, size_);
        if (!remaining_.has(voxel)) continue;
        const uint32_t around = remaining_.around(voxel);
        if ((around & TOWARDS[size_t(direction)]) == 0 && can_go(around))
            border[size_t(voxel.x % 2 + 2 * (voxel.y % 2) + 4 * (voxel.z % 2))].push_back(index);
    }
    for (const std::vector<int64_t>& apart : border)
        for (const int64_t index : apart) {
            const Size3 voxel = position_of(index, size_);
            const uint32_t around = remaining_.around(voxel);
            if (!can_go(around)) continue;
            remaining_.remove(voxel);
            for (uint32_t left = around & AROUND; left != 0; left &= left - 1) {
                const int place = std::countr_zero(left);
                const Size3 neighbour = voxel + Size3(place % 3 - 1, place / 3 % 3 - 1, place / 9 - 1);
                if (may_go.has(neighbour)) next.push_back(index_of(neighbour, size_));
            }
        }
}

void Thinning::remove(std::vector<int64_t> voxels, Remaining& may_go, const Progress& progress, double done)
{
    while (!voxels.empty()) {
        std::vector<int64_t> next;
        for (int direction = 0; direction < 6; ++direction) {
            remove_from(direction, voxels, may_go, next);
            tell(progress, done);
        }
        std::ranges::sort(next);
        next.erase(std::ranges::unique(next).begin(), next.end());
        voxels = std::move(next);
    }
}

/// The voxels of `set` that are not in `without`, as indices, ascending.
std::vector<int64_t> indices_of(const BrickSet& set, const BrickSet& without, const Mask& mask)
{
    std::vector<int64_t> indices;
    for (const auto& [brick, bits] : set) {
        const auto other = without.find(brick);
        const Size3 corner = mask.box_of(brick).lower;
        for (size_t row = 0; row < bits.size(); ++row)
            for (uint32_t left = bits[row] & (other == without.end() ? ~0u : ~other->second[row]); left != 0;
                 left &= left - 1) {
                const Size3 at(std::countr_zero(left), int64_t(row) % BRICK_SIDE, int64_t(row) / BRICK_SIDE);
                indices.push_back(index_of(corner + at, mask.size()));
            }
    }
    std::ranges::sort(indices);
    return indices;
}

int64_t voxels_in(const BrickSet& set)
{
    int64_t count = 0;
    for (const auto& [brick, bits] : set) count += count_of(bits);
    return count;
}

}  // namespace

bool is_simple_point(uint32_t around)
{
    const uint32_t inside = around & AROUND, outside = ~around & FACES_AND_EDGES;
    const uint32_t beside = outside & OVER_FACES[MIDDLE];
    if (inside == 0 || beside == 0) return false;
    return part_of_set(inside, lowest(inside), OVER_ALL) == inside &&
           (beside & ~part_of_set(outside, lowest(beside), OVER_FACES)) == 0;
}

BrickSet thinned(const BrickSet& set, const Reach& reach, const std::function<void(uint64_t)>& takes,
                 const Progress& progress)
{
    const uint64_t for_sets = 4 * set.size() * sizeof(BrickBits);
    takes(for_sets);
    Thinning thinning(set, reach);
    const double step = std::min({reach.spacing.x, reach.spacing.y, reach.spacing.z});
    const int64_t voxels = voxels_in(set),
                  none_outside = reach.mask.size().x * reach.mask.size().y * reach.mask.size().z;
    BrickSet layers;
    int64_t done = 0;
    for (double distance = step; done < voxels; distance = std::max(distance + step, 1.1 * distance)) {
        const bool is_last = voxels == none_outside || distance / step > double(MAX_REACH);
        const Reach within{reach.mask, reach.spacing, distance};
        BrickSet next = is_last ? set : rim_of(set, within, {});
        const int64_t reached = voxels_in(next);
        if (reached > done) {
            takes(for_sets + 2 * sizeof(int64_t) * uint64_t(reached - done));
            Remaining may_go(next, reach.mask);
            thinning.remove(indices_of(next, layers, reach.mask), may_go, progress, double(done) / double(voxels));
            layers = std::move(next);
        }
        done = reached;
        tell(progress, double(done) / double(voxels));
    }
    return thinning.take();
}

}  // namespace shvr

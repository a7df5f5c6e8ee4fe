#include "engine/annotation/sets/voxels_near.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "engine/annotation/sets/near_rows.h"
#include "engine/annotation/sets/parabolas.h"
#include "engine/base/error.h"

namespace shvr {

namespace {

constexpr int64_t TILE_BRICKS = 2, TILE = TILE_BRICKS * BRICK_SIDE;
constexpr uint16_t NONE = std::numeric_limits<uint16_t>::max();

class TileSearch {
public:
    TileSearch(const BrickSet& set, bool is_inverted, const Reach& reach)
        : set_(set),
          is_inverted_(is_inverted),
          mask_(reach.mask),
          spacing_(reach.spacing),
          most_(reach.most_squared()),
          reach_(reach.voxels()),
          along_y_(spacing_.y),
          along_z_(spacing_.z)
    {}
    /// Searches these bricks of a tile for voxels near the set, and adds them to `found`.
    void search(const Size3& tile, std::span<const int64_t> bricks, BrickSet& found);

private:
    void gather(const Size3& tile);
    uint32_t word(const Size3& brick, int64_t row) const;
    void search_row(int64_t y, int64_t z);
    void search_columns(int64_t z);
    template <class Take>
    void search_depths(const Take& take);

    const BrickSet& set_;
    bool is_inverted_;
    const Mask& mask_;
    glm::dvec3 spacing_;
    double most_;
    Size3 reach_;
    Parabolas along_y_, along_z_;

    VoxelBox tile_, window_;  ///< the tile, and the tile enlarged by the reach, both clipped to the volume
    VoxelBox grid_;           ///< bricks that the window meets
    std::vector<const BrickBits*> bricks_;
    std::vector<int64_t> places_;      ///< x of the set's voxels in one row of the window
    std::vector<uint16_t> near_x_;     ///< by x in the tile, y in the window: distance in x to the set, in voxels
    std::vector<double> near_xy_;      ///< by x and y in the tile, z in the window: squared distance within a slice
    std::vector<uint8_t> is_reached_;  ///< by slice of the window: whether near_xy_ has finite values there
};

void TileSearch::gather(const Size3& tile)
{
    const Size3 size = mask_.size();
    tile_ = {TILE * tile, glm::min(TILE * (tile + int64_t{1}), size)};
    window_ = {glm::max(tile_.lower - reach_, Size3(0)), glm::min(tile_.upper + reach_, size)};
    grid_ = {window_.lower / BRICK_SIDE, (window_.upper + (BRICK_SIDE - 1)) / BRICK_SIDE};
    bricks_.clear();
    for (int64_t z = grid_.lower.z; z < grid_.upper.z; ++z)
        for (int64_t y = grid_.lower.y; y < grid_.upper.y; ++y)
            for (int64_t x = grid_.lower.x; x < grid_.upper.x; ++x) {
                const auto brick = set_.find(index_of(Size3(x, y, z), mask_.brick_counts()));
                bricks_.push_back(brick == set_.end() ? nullptr : &brick->second);
            }
}

/// The voxels of a brick's row that distances are measured to: the set's or, if inverted, its complement's.
uint32_t TileSearch::word(const Size3& brick, int64_t row) const
{
    const BrickBits* const bits = bricks_[size_t(index_of(brick - grid_.lower, grid_.size()))];
    const uint32_t word = bits ? (*bits)[size_t(row)] : 0;
    if (!is_inverted_) return word;
    const int64_t beyond = std::max<int64_t>(BRICK_SIDE * (brick.x + 1) - mask_.size().x, 0);
    return ~word & (~0u >> beyond);
}

void TileSearch::search_row(int64_t y, int64_t z)
{
    const Size3 size = tile_.size();
    uint16_t* const row = near_x_.data() + size.x * (y - window_.lower.y);
    places_.clear();
    for (int64_t x = grid_.lower.x; x < grid_.upper.x; ++x) {
        const Size3 brick(x, y / BRICK_SIDE, z / BRICK_SIDE);
        for (uint32_t left = word(brick, y % BRICK_SIDE + BRICK_SIDE * (z % BRICK_SIDE)); left != 0; left &= left - 1)
            places_.push_back(BRICK_SIDE * x + std::countr_zero(left));
    }
    if (places_.empty()) return std::fill(row, row + size.x, NONE);
    size_t nearest = 0;
    for (int64_t x = 0; x < size.x; ++x) {
        const int64_t at = tile_.lower.x + x;
        while (nearest + 1 < places_.size() && std::abs(places_[nearest + 1] - at) <= std::abs(places_[nearest] - at))
            ++nearest;
        row[x] = uint16_t(std::min<int64_t>(std::abs(places_[nearest] - at), NONE));
    }
}

/// Computes squared distances within the slice z from the distances along x.
void TileSearch::search_columns(int64_t z)
{
    const Size3 size = tile_.size(), window = window_.size();
    for (int64_t y = window_.lower.y; y < window_.upper.y; ++y) search_row(y, z);
    double* const slice = near_xy_.data() + size.x * size.y * (z - window_.lower.z);
    std::fill(slice, slice + size.x * size.y, INFINITE);
    const int64_t first = tile_.lower.y - window_.lower.y;
    bool is_reached = false;
    for (int64_t x = 0; x < size.x; ++x) {
        const auto at = [&](int64_t y) {
            const uint16_t near = near_x_[size_t(x + size.x * y)];
            const double away = spacing_.x * near;
            return near == NONE ? INFINITE : away * away;
        };
        if (!along_y_.build(window.y, most_, at)) continue;
        is_reached = true;
        along_y_.evaluate(first, first + size.y,
                          [&](int64_t y, double squared) { slice[x + size.x * (y - first)] = squared; });
    }
    is_reached_[size_t(z - window_.lower.z)] = is_reached;
}

/// Calls `take` for each voxel of the tile that is near the set, with its position in the tile.
template <class Take>
void TileSearch::search_depths(const Take& take)
{
    const Size3 size = tile_.size(), window = window_.size();
    const int64_t first = tile_.lower.z - window_.lower.z;
    for (int64_t y = 0; y < size.y; ++y)
        for (int64_t x = 0; x < size.x; ++x) {
            const auto at = [&](int64_t z) {
                return is_reached_[size_t(z)] != 0 ? near_xy_[size_t(x + size.x * (y + size.y * z))] : INFINITE;
            };
            if (!along_z_.build(window.z, most_, at)) continue;
            along_z_.evaluate(first, first + size.z, [&](int64_t z, double squared) {
                if (squared <= most_) take(Size3(x, y, z - first));
            });
        }
}

void TileSearch::search(const Size3& tile, std::span<const int64_t> bricks, BrickSet& found)
{
    gather(tile);
    if (!is_inverted_ && std::ranges::all_of(bricks_, [](const BrickBits* bits) { return bits == nullptr; })) return;
    const Size3 size = tile_.size(), window = window_.size();
    near_x_.resize(size_t(size.x * window.y));
    near_xy_.resize(size_t(size.x * size.y * window.z));
    is_reached_.assign(size_t(window.z), 0);
    for (int64_t z = window_.lower.z; z < window_.upper.z; ++z) search_columns(z);
    if (std::ranges::all_of(is_reached_, [](uint8_t is) { return is == 0; })) return;
    std::array<BrickBits, size_t(TILE_BRICKS * TILE_BRICKS * TILE_BRICKS)> near{};
    search_depths([&](const Size3& at) {
        BrickBits& bits = near[size_t(index_of(at / BRICK_SIDE, Size3(TILE_BRICKS)))];
        bits[size_t(at.y % BRICK_SIDE + BRICK_SIDE * (at.z % BRICK_SIDE))] |= 1u << (at.x % BRICK_SIDE);
    });
    for (const int64_t brick : bricks) {
        const Size3 in_tile = position_of(brick, mask_.brick_counts()) - TILE_BRICKS * tile;
        const BrickBits& bits = near[size_t(index_of(in_tile, Size3(TILE_BRICKS)))];
        if (!is_empty(bits)) found.emplace(brick, bits);
    }
}

bool is_short(const Reach& reach)
{
    const Size3 voxels = reach.voxels();
    return std::max({voxels.x, voxels.y, voxels.z}) <= MAX_ROW_REACH;
}

template <class Wanted>
BrickSet near_by_rows(const BrickSet& set, bool is_inverted, std::span<const int64_t> bricks, const Reach& reach,
                      const Progress& progress, const Wanted& wanted)
{
    NearRows search(set, is_inverted, reach);
    BrickSet found;
    for (size_t done = 0; done < bricks.size(); ++done) {
        const BrickBits bits = search.search(bricks[done], wanted(bricks[done]));
        if (!is_empty(bits)) found.emplace_hint(found.end(), bricks[done], bits);
        tell(progress, double(done + 1) / double(bricks.size()));
    }
    return found;
}

BrickSet near_by_tiles(const BrickSet& set, bool is_inverted, std::span<const int64_t> bricks, const Reach& reach,
                       const Progress& progress)
{
    std::map<std::array<int64_t, 3>, std::vector<int64_t>> tiles;
    for (const int64_t brick : bricks) {
        const Size3 tile = position_of(brick, reach.mask.brick_counts()) / TILE_BRICKS;
        tiles[{tile.z, tile.y, tile.x}].push_back(brick);
    }
    TileSearch search(set, is_inverted, reach);
    BrickSet found;
    size_t done = 0;
    for (const auto& [tile, its_bricks] : tiles) {
        search.search({tile[2], tile[1], tile[0]}, its_bricks, found);
        tell(progress, double(++done) / double(tiles.size()));
    }
    return found;
}

}  // namespace

Size3 Reach::voxels() const
{
    const glm::dvec3 voxels = glm::floor(std::sqrt(most_squared()) / spacing);
    for (int axis = 0; axis < 3; ++axis)
        if (!(voxels[axis] <= double(MAX_REACH)))
            fail("the distance is ", distance, ", ", voxels[axis], " voxels along ", "xyz"[axis], "; expected at most ",
                 MAX_REACH, " voxels");
    return Size3(voxels);
}

std::vector<int64_t> bricks_near(const BrickSet& set, const Reach& reach)
{
    const Size3 voxels = reach.voxels();
    std::set<int64_t> bricks;
    for (const auto& [brick, bits] : set) {
        const VoxelBox box = reach.mask.box_of(brick);
        // The range of rows and slices with voxels; a tighter range along x would not be worth its cost.
        Size3 first = box.size(), last(0);
        for (int64_t row = 0; row < int64_t(bits.size()); ++row)
            if (bits[size_t(row)] != 0) {
                const Size3 at(0, row % BRICK_SIDE, row / BRICK_SIDE);
                first = glm::min(first, at);
                last = glm::max(last, at + Size3(box.size().x, 1, 1));
            }
        const Size3 lower = glm::max(box.lower + first - voxels, Size3(0)) / BRICK_SIDE,
                    upper = (glm::min(box.lower + last + voxels, reach.mask.size()) + (BRICK_SIDE - 1)) / BRICK_SIDE;
        for (int64_t z = lower.z; z < upper.z; ++z)
            for (int64_t y = lower.y; y < upper.y; ++y)
                for (int64_t x = lower.x; x < upper.x; ++x)
                    bricks.insert(index_of(Size3(x, y, z), reach.mask.brick_counts()));
    }
    return {bricks.begin(), bricks.end()};
}

BrickSet voxels_near(const BrickSet& set, std::span<const int64_t> bricks, const Reach& reach, const Progress& progress)
{
    if (!is_short(reach)) return near_by_tiles(set, false, bricks, reach, progress);
    return near_by_rows(set, false, bricks, reach, progress,
                        [&](int64_t brick) { return bits_inside(reach.mask.box_of(brick).size()); });
}

BrickSet rim_of(const BrickSet& set, const Reach& reach, const Progress& progress)
{
    std::vector<int64_t> bricks;
    for (const auto& [brick, bits] : set) bricks.push_back(brick);
    if (is_short(reach))
        return near_by_rows(set, true, bricks, reach, progress, [&](int64_t brick) { return set.at(brick); });
    BrickSet rim = near_by_tiles(set, true, bricks, reach, progress);
    for (auto& [brick, bits] : rim) {
        const BrickBits& held = set.at(brick);
        for (size_t row = 0; row < bits.size(); ++row) bits[row] &= held[row];
    }
    std::erase_if(rim, [](const auto& each) { return is_empty(each.second); });
    return rim;
}

}  // namespace shvr

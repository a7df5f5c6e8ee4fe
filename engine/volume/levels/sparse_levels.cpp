#include "engine/volume/levels/sparse_levels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "engine/volume/grid.h"
#include "engine/volume/halving.h"
#include "engine/volume/voxel_dispatch.h"
#include "engine/volume/voxel_numbers.h"
#include "engine/volume/voxel_walk.h"

namespace shvr {
namespace {

constexpr int64_t TILE = 8, TILE_VOXELS = TILE * TILE * TILE;
/// Memory of a tile in addition to its voxels: its entries in the tables of positions and indices.
constexpr uint64_t TABLE_BYTES = 80;
/// If more than this fraction of a volume is stored, dense levels take less memory and are faster than sparse ones.
constexpr double MAX_SHARE = 0.25;

uint64_t key_of(const Size3& tile)
{
    return uint64_t(tile.x) | uint64_t(tile.y) << 21 | uint64_t(tile.z) << 42;
}

/// Returns the smallest box that covers `box`, in voxels of the level that is `levels` levels coarser.
VoxelBox coarser(const VoxelBox& box, int levels)
{
    const int64_t side = int64_t{1} << levels;
    return {box.lower / side, (box.upper - int64_t{1}) / side + int64_t{1}};
}

}  // namespace

void SparseLevels::Level::add(const Size3& tile)
{
    if (!index.try_emplace(key_of(tile), tiles.size()).second) return;
    tiles.push_back(tile);
    const Size3 first = glm::max(tile * TILE - int64_t{1}, Size3(0)) / BRICK_SIDE;
    const Size3 last = ((tile + int64_t{1}) * TILE) / BRICK_SIDE;
    for (int64_t z = first.z; z <= last.z; ++z)
        for (int64_t y = first.y; y <= last.y; ++y)
            for (int64_t x = first.x; x <= last.x; ++x) bricks.insert({0, {x, y, z}});
}

void SparseLevels::Level::add_all_in(const VoxelBox& box)
{
    const Size3 first = box.lower / TILE, last = (box.upper - int64_t{1}) / TILE;
    for (int64_t z = first.z; z <= last.z; ++z)
        for (int64_t y = first.y; y <= last.y; ++y)
            for (int64_t x = first.x; x <= last.x; ++x) add({x, y, z});
}

std::optional<SparseLevels> SparseLevels::plan(const VolumeSource& source, int levels)
{
    SparseLevels planned;
    planned.size_ = source.info().size;
    planned.type_ = source.info().type;
    planned.first_ = source.levels();
    planned.levels_.resize(size_t(std::max(levels - planned.first_, 0)));
    if (planned.levels_.empty()) return std::nullopt;
    Level& finest = planned.levels_.front();
    for (int level = 0; level < planned.first_; ++level) {
        const std::optional<StoredBlocks> stored = source.stored_blocks(level, MAX_STORED_BLOCKS);
        if (!stored) return std::nullopt;
        const Size3 size = size_of_level(planned.size_, level);
        if (double(voxels_stored(*stored, size)) > MAX_SHARE * double(size.x) * double(size.y) * double(size.z))
            return std::nullopt;
        planned.fill_ = stored->fill;  // of the source's coarsest level, and so of all computed levels
        if (std::isfinite(stored->fill))
            planned.fills_ = {std::min(planned.fills_.lower, stored->fill),
                              std::max(planned.fills_.upper, stored->fill)};
        for (const glm::ivec3& block : stored->blocks)
            finest.add_all_in(coarser(box_of_block(*stored, block, size), planned.first_ - level));
    }
    for (size_t level = 1; level < planned.levels_.size(); ++level)
        for (const Size3& tile : planned.levels_[level - 1].tiles) planned.levels_[level].add(tile / int64_t{2});
    return planned;
}

uint64_t SparseLevels::bytes() const
{
    uint64_t tiles = 0;
    for (const Level& level : levels_) tiles += level.tiles.size();
    return tiles * (TILE_VOXELS * bytes_of(type_) + TABLE_BYTES);
}

template <class T>
void SparseLevels::build_tile(const VolumeSource& source, int level, size_t tile)
{
    Level& made = levels_[size_t(level - first_)];
    const Size3 corner = made.tiles[tile] * TILE;
    const VoxelBox fine{corner * int64_t{2}, glm::min((corner + TILE) * int64_t{2}, size_of_level(size_, level - 1))};
    const Size3 extent = fine.size();
    std::array<T, 8 * TILE_VOXELS> voxels;
    const std::span<T> part(voxels.data(), size_t(extent.x * extent.y * extent.z));
    if (level == first_)
        source.read_level(level - 1, fine, std::as_writable_bytes(part));
    else
        read(level - 1, fine, std::as_writable_bytes(part));
    T* const first = reinterpret_cast<T*>(made.voxels.data()) + size_t(TILE_VOXELS) * tile;
    for (int64_t z = 0; z < extent.z; z += 2)
        for (int64_t y = 0; y < extent.y; y += 2) {
            HalvingRows<T> rows;
            for (int64_t slice = z; slice < std::min(z + 2, extent.z); ++slice)
                for (int64_t row = y; row < std::min(y + 2, extent.y); ++row)
                    rows.first[size_t(rows.count++)] = part.data() + extent.x * (row + extent.y * slice);
            halve_rows(rows, extent.x, first + TILE * (y / 2 + TILE * (z / 2)));
        }
}

void SparseLevels::build(const VolumeSource& source, const Progress& progress)
{
    size_t all = 0, done = 0;
    for (const Level& level : levels_) all += level.tiles.size();
    with_voxel_type(type_, [&]<class T>(T) {
        for (int level = first_; level < first_ + int(levels_.size()); ++level) {
            Level& made = levels_[size_t(level - first_)];
            made.voxels.resize(made.tiles.size() * size_t(TILE_VOXELS) * sizeof(T));
            for (size_t tile = 0; tile < made.tiles.size(); ++tile) {
                build_tile<T>(source, level, tile);
                if (++done % 64 == 0) tell(progress, double(done) / double(all));
            }
        }
    });
}

void SparseLevels::read(int level, const VoxelBox& box, std::span<std::byte> voxels) const
{
    const Level& from = at(level);
    const Size3 extent = box.size();
    const size_t voxel_bytes = bytes_of(type_);
    std::array<std::byte, 8> fill{};
    if (std::isfinite(fill_))
        store_voxels(type_, std::span(&fill_, 1), fill.data());
    else
        with_voxel_type(type_, [&]<class T>(T) {
            const auto value = static_cast<T>(std::numeric_limits<double>::quiet_NaN());  // as halving computes it
            std::memcpy(fill.data(), &value, sizeof value);
        });
    const Size3 first = box.lower / TILE, last = (box.upper - int64_t{1}) / TILE;
    for (int64_t z = first.z; z <= last.z; ++z)
        for (int64_t y = first.y; y <= last.y; ++y)
            for (int64_t x = first.x; x <= last.x; ++x) {
                const Size3 corner = TILE * Size3(x, y, z);
                const auto found = from.index.find(key_of({x, y, z}));
                const Size3 lower = glm::max(corner, box.lower), upper = glm::min(corner + TILE, box.upper);
                for (int64_t slice = lower.z; slice < upper.z; ++slice)
                    for (int64_t row = lower.y; row < upper.y; ++row) {
                        std::byte* to = voxels.data() +
                                        voxel_bytes * size_t(index_of(Size3(lower.x, row, slice) - box.lower, extent));
                        if (found == from.index.end()) {
                            for (int64_t i = lower.x; i < upper.x; ++i, to += voxel_bytes)
                                std::memcpy(to, fill.data(), voxel_bytes);
                            continue;
                        }
                        const Size3 in = Size3(lower.x, row, slice) - corner;
                        const auto at_voxel = size_t(in.x + TILE * (in.y + TILE * in.z));
                        std::memcpy(to,
                                    from.voxels.data() + voxel_bytes * (size_t(TILE_VOXELS) * found->second + at_voxel),
                                    voxel_bytes * size_t(upper.x - lower.x));
                    }
            }
}

bool SparseLevels::is_gap(int level, const Size3& brick) const
{
    return !at(level).bricks.contains({0, glm::ivec3(brick)});
}

}  // namespace shvr

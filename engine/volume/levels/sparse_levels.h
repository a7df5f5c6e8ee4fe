#pragma once
// Coarser levels of a sparse volume, in memory. Voxels exist only above stored voxels, so that the levels take a
// seventh of the bytes of the stored part. For pyramid_source.cpp.

#include <limits>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "engine/volume/brick_key.h"
#include "engine/volume/source.h"

namespace shvr {

/// Computes coarser levels from the source's coarsest level. The source's own levels are not copied.
class SparseLevels {
public:
    /// Plans up to `levels` levels, including the source's own, without reading voxels. Null if the source cannot list
    /// its stored blocks, or stores so many that dense levels would be smaller.
    static std::optional<SparseLevels> plan(const VolumeSource& source, int levels);

    uint64_t bytes() const;
    /// Reads the stored part of the source's coarsest level. `source` must be the source passed to `plan`.
    void build(const VolumeSource& source, const Progress& progress);

    /// Reads voxels of a computed level; `level` must not be a level of the source.
    void read(int level, const VoxelBox& box, std::span<std::byte> voxels) const;
    /// Whether nothing is stored in a brick, one voxel around it, and the finer levels below.
    bool is_gap(int level, const Size3& brick) const;
    /// Returns the range of voxels in a gap, on all levels; lower > upper if none is finite.
    ValueRange fills() const { return fills_; }

private:
    /// Tiles of TILE^3 voxels.
    struct Level {
        std::vector<Size3> tiles{};
        std::unordered_map<uint64_t, size_t> index{};  ///< index of each tile, by position
        std::unordered_set<BrickKey, BrickKeyHash> bricks{};
        std::vector<std::byte> voxels{};

        void add(const Size3& tile);
        /// Adds all tiles that a box of voxels intersects.
        void add_all_in(const VoxelBox& box);
    };
    const Level& at(int level) const { return levels_[size_t(level - first_)]; }
    template <class T>
    void build_tile(const VolumeSource& source, int level, size_t tile);

    Size3 size_{0};
    VoxelType type_ = VoxelType::uint8;
    double fill_ = 0.0;
    ValueRange fills_{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
    int first_ = 1;              ///< the finest level in memory
    std::vector<Level> levels_;  ///< from `first_` on
};

}  // namespace shvr

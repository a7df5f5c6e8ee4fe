#pragma once
// Places masks that other programs cropped or reoriented: the mask's origin, directions and spacing give the place of
// its voxels on the grid of the annotated volume. Any thread may call these.

#include <array>
#include <filesystem>
#include <optional>

#include "engine/annotation/trace/trace_space.h"
#include "engine/volume/source.h"

namespace shvr {

/// Maps voxel v of a mask to the volume's voxel `first` + sum, over the mask's axes a, of sign[a] * v[a] along axis[a].
struct GridPlace {
    std::array<int, 3> axis{0, 1, 2};
    std::array<int, 3> sign{1, 1, 1};
    Size3 first{0};
    bool operator==(const GridPlace&) const = default;
};

/// Returns the place that the mask's file states. Returns null if mask and volume have the same grid: equal sizes and,
/// if both state a place, equal places. Fails, with the reason, if the mask is not on the volume's grid: other spacing
/// or direction, a shift by a fraction of a voxel, no stated position, or no voxel in common.
std::optional<GridPlace> place_of_mask(const std::filesystem::path& path, const VolumeInfo& mask,
                                       const TraceSpace& volume);
/// Returns a phrase like "its 13, 13, 13 voxels are placed at 2, 2, 2 of this volume, with x in reverse order".
std::string in_words(const GridPlace& place, const Size3& mask, const TraceSpace& volume);

/// The mask on the volume's grid, with 0 around it. The cost depends on the mask alone, not on the volume's size.
class PlacedSource final : public VolumeSource {
public:
    /// `mask` must outlive this object.
    PlacedSource(const VolumeSource& mask, const GridPlace& place, const TraceSpace& volume);

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override;
    std::optional<StoredBlocks> stored_blocks(int level, int64_t most) const override;

    /// Fails if any voxel of the mask outside the volume is not 0, naming the first such voxel.
    void expect_nothing_outside(const std::filesystem::path& path) const;

private:
    VoxelBox on_volume(const VoxelBox& of_mask) const;
    VoxelBox on_mask(const VoxelBox& of_volume) const;

    const VolumeSource& mask_;
    GridPlace place_;
    VoxelBox covered_;  ///< the mask's box in voxels of the volume; may extend beyond the volume
};

}  // namespace shvr

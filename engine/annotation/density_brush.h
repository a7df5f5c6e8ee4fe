#pragma once
// What a stroke does to density offsets: the rule of density.h, for the voxels that a brush selects at each position.
//
//     p(v) = P                                  flat
//     p(v) = P max(0, 1 - d / r)                distance: d from the voxel's centre to the position, in physical units;
//                                               r the brush's radius (along x, times the spacing)
//
// Offsets are rounded as engine/volume/offset_brick.h says, P as well as p. Main thread.

#include <memory>

#include "engine/annotation/density.h"
#include "engine/annotation/region.h"
#include "engine/base/spelling.h"

namespace shvr {

enum class Falloff { flat, distance };
inline constexpr Spelling<Falloff> FALLOFFS[] = {{Falloff::flat, "flat"}, {Falloff::distance, "distance"}};
constexpr std::span<const Spelling<Falloff>> spellings_of(Falloff)
{
    return FALLOFFS;
}

/// What is painted beside, or instead of, a group.
struct DensityBrush {
    /// P, in intensity units. Nothing: what makes the paint threshold as bright as the lowest point of the transfer
    /// function (`automatic_offset`), which whoever paints puts in its place.
    std::optional<double> offset{};
    Falloff falloff = Falloff::flat;
    bool operator==(const DensityBrush&) const = default;
};

/// The lowest point of the transfer function less the paint threshold; 0 where that is negative: such voxels are seen.
double automatic_offset(double lowest_point, double paint_threshold);

/// The offset of a voxel that had `old`, after P and p(v) <= P: the rule, on bits of the type.
uint32_t painted_offset(VoxelType type, uint32_t old, uint32_t most, uint32_t here);

class DensityStroke {
public:
    /// Fails where the offset is not a finite number. What is beyond `offset_limit` counts as the limit.
    DensityStroke(Size3 size, const glm::dvec3& spacing, VoxelType type, double offset, Falloff falloff);
    /// The voxels of `region`, which is around `centre_voxel`, whose bit is set (VoxelSelection::add).
    void add(const BrushRegion& region, std::span<const uint32_t> words, const glm::dvec3& centre_voxel,
             double radius_voxels);
    /// The records that paint all that was added; voxels that stay as they are are left out.
    std::vector<DensityBrickChange> changes(const DensityField& field) const;

private:
    Size3 size_;
    glm::i64vec3 counts_;
    glm::dvec3 spacing_;
    VoxelType type_;
    double offset_;
    Falloff falloff_;
    VoxelSelection selection_;
    std::map<int64_t, std::unique_ptr<OffsetBrick>> strongest_;  ///< p of selected voxels, over all positions
};

}  // namespace shvr

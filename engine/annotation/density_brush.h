#pragma once
// Applies a stroke to density offsets: the rule of density.h, for the voxels that a brush selects at each position.
//
//     p(v) = P                                  flat
//     p(v) = P max(0, 1 - d / r)                distance: d from the voxel's centre to the position, in physical units;
//                                               r the brush's radius (along x, times the spacing)
//
// P and p are both rounded as in engine/volume/offset_brick.h. Main thread.

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

/// The density part of a brush, painted together with a group or instead of one.
struct DensityBrush {
    /// P, in intensity units. Null: automatic, an offset that makes voxels at the paint threshold as bright as the
    /// lowest point of the transfer function. Callers must replace null by `automatic_offset` before painting.
    std::optional<double> offset{};
    Falloff falloff = Falloff::flat;
    bool operator==(const DensityBrush&) const = default;
};

/// The lowest point of the transfer function minus the paint threshold, or 0 if that is negative, because voxels at the
/// threshold are visible already.
double automatic_offset(double lowest_point, double paint_threshold);

/// Applies the rule of density.h: returns the new offset of a voxel. All offsets are given as bits
/// (engine/volume/offset_brick.h): `old` is the voxel's offset, `most` is P, and `here` is p(v).
uint32_t painted_offset(VoxelType type, uint32_t old, uint32_t most, uint32_t here);

class DensityStroke {
public:
    /// Fails if the offset is not finite. Clamps offsets to `offset_limit`.
    DensityStroke(Size3 size, const glm::dvec3& spacing, VoxelType type, double offset, Falloff falloff);
    /// Adds the voxels of `region`, around `centre_voxel`, whose bits in `words` are set (VoxelSelection::add).
    void add(const BrushRegion& region, std::span<const uint32_t> words, const glm::dvec3& centre_voxel,
             double radius_voxels);
    /// Returns the records that paint all voxels added so far, omitting voxels whose offset does not change.
    std::vector<DensityBrickChange> changes(const DensityField& field) const;

private:
    Size3 size_;
    glm::i64vec3 counts_;
    glm::dvec3 spacing_;
    VoxelType type_;
    double offset_;
    Falloff falloff_;
    VoxelSelection selection_;
    std::map<int64_t, std::unique_ptr<OffsetBrick>> strongest_;  ///< brick -> per selected voxel, its p of greatest
                                                                 ///< magnitude over all positions
};

}  // namespace shvr

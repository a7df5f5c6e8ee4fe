#pragma once
// What one stroke of a brush is: the same description for scripts, the window and a stylus.

#include <optional>
#include <vector>

#include "engine/annotation/density_brush.h"

namespace shvr {

enum class Brush { fill, flood, speckle };
inline constexpr Spelling<Brush> BRUSHES[] = {
    {Brush::fill, "fill"}, {Brush::flood, "flood"}, {Brush::speckle, "speckle"}};
constexpr std::span<const Spelling<Brush>> spellings_of(Brush)
{
    return BRUSHES;
}

inline constexpr Spelling<RegionShape> REGION_SHAPES[] = {{RegionShape::ball, "ball"}, {RegionShape::box, "box"}};
constexpr std::span<const Spelling<RegionShape>> spellings_of(RegionShape)
{
    return REGION_SHAPES;
}

struct PaintOp {
    Brush brush = Brush::flood;
    RegionShape region = RegionShape::ball;
    uint8_t group = 1;             ///< 0 erases
    double threshold = 0.0;        ///< intensity units of the file; at or above
    double radius_voxels = 6.0;    ///< along x
    int connectivity = 6;          ///< 6 or 26
    std::vector<glm::dvec3> path;  ///< voxel coordinates
    /// Offsets for the selected voxels; group 0 takes theirs away.
    std::optional<DensityBrush> density{};
    bool paints_group = true;  ///< false: offsets alone
    bool operator==(const PaintOp&) const = default;
};

}  // namespace shvr

#pragma once
// What one stroke of a brush is: the same description for scripts, the window and a stylus.

#include <optional>
#include <utility>
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

/// How a person has set the brush.
struct BrushSettings {
    Brush brush = Brush::flood;
    RegionShape region = RegionShape::ball;
    uint8_t group = 1;                  ///< 0 erases
    std::optional<double> threshold{};  ///< intensity; the middle of what the transfer function shows
    double radius_voxels = 6.0;         ///< along x; of the probe, too
    int connectivity = 6;               ///< 6 or 26
    /// Density painting: the brush raises intensities, beside painting its group or instead of it.
    std::optional<DensityBrush> density{};
    bool paints_group = true;  ///< false, where there is `density`: offsets alone
    bool operator==(const BrushSettings&) const = default;
};

/// One stroke: the settings with a definite threshold, and a path.
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

/// `threshold` is taken where the settings have none.
inline PaintOp stroke_of(const BrushSettings& settings, double threshold, std::vector<glm::dvec3> path = {})
{
    // A new member does not compile until it is here.
    const auto& [brush, region, group, own_threshold, radius_voxels, connectivity, density, paints_group] = settings;
    return {brush,           region,  group,       own_threshold.value_or(threshold), radius_voxels, connectivity,
            std::move(path), density, paints_group};
}

inline BrushSettings settings_of(const PaintOp& op)
{
    const auto& [brush, region, group, threshold, radius_voxels, connectivity, path, density, paints_group] = op;
    return {brush, region, group, threshold, radius_voxels, connectivity, density, paints_group};
}

}  // namespace shvr

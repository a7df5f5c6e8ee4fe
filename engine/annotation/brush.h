#pragma once
// Brushes, and the description of one stroke, shared by scripts, the window and a stylus.

#include <array>
#include <bitset>
#include <optional>
#include <utility>
#include <vector>

#include "engine/annotation/density_brush.h"

namespace shvr {

enum class Brush { fill, flood, speckle };

/// The properties and texts of a brush.
struct BrushRow {
    Brush brush;
    const char* key;    ///< in scripts and sessions
    const char* name;   ///< in sentences
    const char* title;  ///< in menus
    const char* hint;
    bool is_connected;  ///< the brush selects connected voxels, so `connectivity` has an effect
};

/// All brushes, in the order of the enumeration; menus use the same order.
inline constexpr std::array BRUSHES{
    BrushRow{Brush::fill, "fill", "fill", "Fill",
             "Paints every voxel in the probe that is at or above the paint threshold.", false},
    BrushRow{Brush::flood, "flood", "flood fill", "Flood fill",
             "Paints what is connected to the centre of the probe: voxels at or above the threshold, inside the probe.",
             true},
    BrushRow{
        Brush::speckle, "speckle", "speckle fill", "Speckle fill",
        "Paints pieces that lie wholly inside the probe and leaves larger ones alone: clears dirt and noise out of "
        "the view.",
        true},
};

constexpr const BrushRow& row_of(Brush brush)
{
    return BRUSHES.at(size_t(brush));
}

/// The spellings (keys) of all brushes, used for reading and writing.
inline constexpr auto BRUSH_SPELLINGS = [] {
    std::array<Spelling<Brush>, BRUSHES.size()> spellings{};
    for (size_t i = 0; i < BRUSHES.size(); ++i) spellings[i] = {BRUSHES[i].brush, BRUSHES[i].key};
    return spellings;
}();
constexpr std::span<const Spelling<Brush>> spellings_of(Brush)
{
    return BRUSH_SPELLINGS;
}

inline constexpr Spelling<RegionShape> REGION_SHAPES[] = {{RegionShape::ball, "ball"}, {RegionShape::box, "box"}};
constexpr std::span<const Spelling<RegionShape>> spellings_of(RegionShape)
{
    return REGION_SHAPES;
}

/// Groups by number.
using GroupSet = std::bitset<256>;

/// The user's settings of the brush.
struct BrushSettings {
    Brush brush = Brush::flood;
    RegionShape region = RegionShape::ball;
    uint8_t group = 1;                  ///< 0 erases
    std::optional<double> threshold{};  ///< intensity; default: from the transfer function
    double radius_voxels = 6.0;         ///< along x; also the probe's radius
    int connectivity = 6;               ///< 6 or 26
    /// Density painting: the brush raises intensities, either while it paints its group or instead of painting a group.
    std::optional<DensityBrush> density{};
    bool paints_group = true;     ///< false, with `density` set: offsets only
    bool only_unpainted = false;  ///< paints only unpainted voxels, so no group loses voxels
    bool operator==(const BrushSettings&) const = default;
};

/// One stroke: the settings with a definite threshold, and the path along which the brush moved.
struct PaintOp {
    Brush brush = Brush::flood;
    RegionShape region = RegionShape::ball;
    uint8_t group = 1;             ///< 0 erases
    double threshold = 0.0;        ///< voxels at or above this intensity are selected; in units of the file
    double radius_voxels = 6.0;    ///< along x
    int connectivity = 6;          ///< 6 or 26
    std::vector<glm::dvec3> path;  ///< voxel coordinates
    /// Offsets for the selected voxels. With group 0, the stroke removes the voxels' offsets instead.
    std::optional<DensityBrush> density{};
    bool paints_group = true;     ///< false: offsets only
    bool only_unpainted = false;  ///< as in BrushSettings
    GroupSet locked{};            ///< locked groups, which neither lose nor gain voxels; [0] is not set. Neither
                                  ///< `locked` nor `only_unpainted` applies to offsets
    bool operator==(const PaintOp&) const = default;

    /// Whether the stroke unpaints the selected voxels (and removes their offsets, if it paints offsets).
    bool erases() const { return paints_group && group == 0; }
};

/// Returns the stroke that these settings make along a path; uses `threshold` if the settings state none.
inline PaintOp stroke_of(const BrushSettings& settings, double threshold, std::vector<glm::dvec3> path = {})
{
    // A structured binding makes this function fail to compile if a member is added but not handled here.
    const auto& [brush, region, group, own_threshold, radius_voxels, connectivity, density, paints_group,
                 only_unpainted] = settings;
    return {brush,         region,        group,           own_threshold.value_or(threshold),
            radius_voxels, connectivity,  std::move(path), density,
            paints_group,  only_unpainted};
}

}  // namespace shvr

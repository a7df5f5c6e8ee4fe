#pragma once
// Scripts of `shvr annotate`: one JSON object a line, blank lines and lines starting with // are skipped. The same
// structs are what the window will send, so that keys, menus, scripts and a stylus share one language.

#include <filesystem>
#include <map>
#include <optional>
#include <variant>

#include "engine/annotation/density_brush.h"

namespace shvr {

enum class Brush { fill, flood, speckle };

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
/// Tracing, as the window will send it, too. Positions in voxel coordinates, radii in voxels along x.
struct NodeOp {
    glm::dvec3 at{0.0};
    std::optional<double> radius_voxels;  ///< the probe's
    std::optional<uint8_t> group;         ///< the probe's
};
struct SelectOp {
    std::optional<glm::dvec3> near;  ///< the nearest node, or internode of the selected node
    std::optional<uint32_t> number;  ///< where `near` is not given
    bool is_internode = false;
    std::optional<double> within_voxels;  ///< how far the nearest may be; any distance
};
struct SelectSegmentOp {};
struct DeselectOp {};
struct LinkOp {
    std::optional<glm::dvec3> near;         ///< the nearest other node
    std::optional<uint32_t> node;           ///< where `near` is not given
    std::optional<double> within_voxels{};  ///< how far the nearest may be; any distance
};
struct MoveOp {
    glm::dvec3 to{0.0};
};
struct DeleteOp {};
struct GroupOp {
    uint8_t group = 1;
};
struct RadiusOp {
    enum class Of { selected, nodes, internodes };
    Of of = Of::selected;                 ///< the others: all of `group`
    std::optional<double> radius_voxels;  ///< nothing, of internodes only: they taper
    uint8_t group = 0;
};
struct UndoOp {
    int count = 1;
};
struct RedoOp {
    int count = 1;
};
struct SaveOp {};
struct ExpectOp {
    std::map<uint8_t, int64_t> voxels_in_group;
    std::optional<int64_t> voxels_with_offset{};
    std::optional<int64_t> nodes;
    std::optional<int64_t> internodes;
};
using ScriptOp = std::variant<PaintOp, NodeOp, SelectOp, SelectSegmentOp, DeselectOp, LinkOp, MoveOp, DeleteOp, GroupOp,
                              RadiusOp, UndoOp, RedoOp, SaveOp, ExpectOp>;

struct ScriptLine {
    int number = 0;  ///< from 1
    ScriptOp op;
};

/// Reads and checks the whole script before anything runs. Errors name file, line, key, value and what was expected;
/// unknown keys and operations are refused.
std::vector<ScriptLine> read_script(const std::filesystem::path& path);

}  // namespace shvr

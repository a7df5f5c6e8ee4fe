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
using ScriptOp = std::variant<PaintOp, UndoOp, RedoOp, SaveOp, ExpectOp>;

struct ScriptLine {
    int number = 0;  ///< from 1
    ScriptOp op;
};

/// Reads and checks the whole script before anything runs. Errors name file, line, key, value and what was expected;
/// unknown keys and operations are refused.
std::vector<ScriptLine> read_script(const std::filesystem::path& path);

}  // namespace shvr

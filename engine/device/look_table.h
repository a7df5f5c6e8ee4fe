#pragma once
// A transfer function as the device reads it: a table for one step length, plain or pre-integrated, and the intervals
// in which the function is visible. Computed in double precision on the CPU, and cached until an input changes.

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/gpu/memory.h"
#include "engine/look/look.h"
#include "engine/passes/brick_leap.h"
#include "engine/volume/volume.h"
#include "shaders/raycast.h"

namespace shvr {

/// Minimum number of entries of the plain table, and side length of the pre-integrated table.
inline constexpr uint32_t MIN_TABLE_ENTRIES = 4096;
inline constexpr uint32_t STEP_TABLE_SIDE = gpu::TABLE_WIDTH;

/// The range that a table covers: all codes at which the function is not fully transparent.
struct TableRange {
    double lower = 0.0, upper = 0.0;  ///< codes
    Samples samples;                  ///< the same in intensities
};
/// The plain table is small if all control points are at entries, and the function is continuous and nowhere rises up
/// to 1: interpolation between entries then reproduces the function. Otherwise, entries are at most one code apart, so
/// that a step of the function is as sharp as the codes allow; if the function begins and ends at whole codes, entries
/// are at whole codes.
TableRange table_range(const TransferFunction& function, const IntensityWindow& window, bool is_preintegrated);

struct LookTable {
    std::vector<ControlPoint> points;
    double step_voxels = 0.0;  ///< in reference lengths
    bool preintegrated = false;
    bool has_points = false;  ///< whether the table includes the control points, for the integral without steps
    Samples samples;
    std::vector<glm::vec4> texels;  ///< in the layout of raycast.h
    std::vector<uint32_t> visible_intervals;

    bool is_of(const TransferFunction& function, const RenderSettings& render, double step, const Samples& of) const;
};

LookTable make_look_table(const TransferFunction& function, const IntensityWindow& window, double step_voxels,
                          bool is_preintegrated, bool has_points = false);
/// The looks of all 256 colour groups, in the order of their numbers. The first 256 texels hold linear RGB and the
/// opacity per step (0 for hidden groups). The next 256 texels hold the optical depths.
std::vector<glm::vec4> make_group_looks(const Groups& groups, double step_voxels);

/// Sets the parameters shared by all kernels that look up a transfer function table.
template <class Params>
void set_table(Params& params, const TableRange& range)
{
    const uint32_t entries = range.samples.entries;
    params.table_lower = float(range.lower);
    params.table_upper = float(range.upper);
    params.table_scale = float((entries - 1) / std::max(range.upper - range.lower, 1e-6));
    params.table_entries = entries;
}
/// Sets all parameters of the ray caster's table.
void set_look_table(gpu::RaycastParams& params, const TransferFunction& function, const IntensityWindow& window,
                    bool is_preintegrated, bool has_points = false);

/// A table on the device: an rgba32f image in rows of gpu::TABLE_WIDTH. Used only by the renderer's thread.
class DeviceTable {
public:
    DeviceTable(gpu::Memory& memory, std::string name) : memory_(memory), name_(std::move(name)) {}
    /// Marks the uploaded table as stale.
    void invalidate() { is_sent_ = false; }
    /// Returns the table's handle; uploads `texels` unless they are up to date.
    Resource upload(FrameGraph& graph, std::span<const glm::vec4> texels);

private:
    gpu::Memory& memory_;
    std::string name_;
    gpu::Storage image_;
    bool is_sent_ = false;
};

/// A scene's tables, for its transfer function and its groups. Used only by the renderer's thread.
class LookTables {
public:
    explicit LookTables(gpu::Memory& memory)
        : function_on_device_(memory, "transfer function"), groups_on_device_(memory, "groups")
    {}

    /// The table for steps of `step_voxels` reference lengths.
    const LookTable& table_of(const Look& look, const IntensityWindow& window, double step_voxels);
    /// The visible densities, from any cached table, as the step length does not matter. Excludes the guard (leap.h).
    Visibility visibility_of(const Look& look, const IntensityWindow& window);
    Resource upload_function(FrameGraph& graph, const Look& look, const IntensityWindow& window, double step_voxels);
    Resource upload_groups(FrameGraph& graph, const Look& look, double step_voxels);

private:
    std::optional<LookTable> table_;
    DeviceTable function_on_device_;
    std::vector<glm::vec4> groups_;
    DeviceTable groups_on_device_;
};

}  // namespace shvr

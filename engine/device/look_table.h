#pragma once
// A transfer function as the device reads it: a table for one step length, plain or pre-integrated, and the intervals
// of it that are visible. Baked in double on the CPU, and cached until something changes.

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

/// Number of values in the plain table, and along each side of the pre-integrated one.
inline constexpr uint32_t TABLE_ENTRIES = gpu::TABLE_WIDTH * gpu::TABLE_HEIGHT;
inline constexpr uint32_t STEP_TABLE_SIDE = gpu::TABLE_WIDTH;

/// Table coordinate of a code = (code - lower) * scale.
struct TableMap {
    float lower, upper, scale;
};
TableMap table_map(const TransferFunction& function, const IntensityWindow& window, uint32_t entries);

struct LookTable {
    std::vector<ControlPoint> points;
    double step_voxels = 0.0;  ///< reference lengths
    bool preintegrated = false;
    std::vector<glm::vec4> texels;  ///< rows of gpu::TABLE_WIDTH
    std::vector<uint32_t> visible_intervals;

    /// Values along each axis of the table.
    uint32_t entries() const { return preintegrated ? STEP_TABLE_SIDE : TABLE_ENTRIES; }
    bool is_of(const TransferFunction& function, double step, bool is_preintegrated) const;
};

LookTable make_look_table(const TransferFunction& function, double step_voxels, bool is_preintegrated);
/// Linear RGB and opacity of a step for all 256 colour groups, by number; 0 where hidden.
std::vector<glm::vec4> make_group_looks(const Groups& groups, double step_voxels);

/// Sets the parameters shared by all kernels that look up a transfer function table.
template <class Params>
void set_table(Params& params, const TransferFunction& function, const IntensityWindow& window, uint32_t entries)
{
    const TableMap map = table_map(function, window, entries);
    params.table_lower = map.lower;
    params.table_upper = map.upper;
    params.table_scale = map.scale;
    params.table_entries = entries;
}

/// A table on the device: an rgba32f image in rows of gpu::TABLE_WIDTH. One thread, the renderer's.
class DeviceTable {
public:
    DeviceTable(gpu::Memory& memory, std::string name) : memory_(memory), name_(std::move(name)) {}
    /// Marks the uploaded table as stale.
    void invalidate() { is_sent_ = false; }
    /// Its handle; uploads `texels` unless they are up to date.
    Resource upload(FrameGraph& graph, std::span<const glm::vec4> texels);

private:
    gpu::Memory& memory_;
    std::string name_;
    gpu::Storage image_;
    bool is_sent_ = false;
};

/// A scene's tables: of its transfer function, and of its groups. One thread, the renderer's.
class LookTables {
public:
    explicit LookTables(gpu::Memory& memory)
        : function_on_device_(memory, "transfer function"), groups_on_device_(memory, "groups")
    {}

    /// The table for steps of that many reference lengths.
    const LookTable& table_of(const Look& look, double step_voxels);
    /// What is visible, from whichever table there is: the step length does not matter.
    Visibility visibility_of(const Look& look, const IntensityWindow& window);
    Resource upload_function(FrameGraph& graph, const Look& look, double step_voxels);
    Resource upload_groups(FrameGraph& graph, const Look& look, double step_voxels);

private:
    std::optional<LookTable> table_;
    DeviceTable function_on_device_;
    std::vector<glm::vec4> groups_;
    DeviceTable groups_on_device_;
};

}  // namespace shvr

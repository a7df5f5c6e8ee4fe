#pragma once
// A transfer function as the device reads it: a table for one length of step, plain or pre-integrated, and which
// stretches of it show anything. Baked in double on the CPU, kept as long as it is the same.

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

/// Values along the plain table, and along a side of the pre-integrated one.
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

    /// Values along each axis of it.
    uint32_t entries() const { return preintegrated ? STEP_TABLE_SIDE : TABLE_ENTRIES; }
    bool is_of(const TransferFunction& function, double step, bool is_preintegrated) const;
};

LookTable make_look_table(const TransferFunction& function, double step_voxels, bool is_preintegrated);
/// Of all 256 colour groups, by number: linear RGB, opacity of a step; nothing where they are hidden.
std::vector<glm::vec4> make_group_looks(const Groups& groups, double step_voxels);

/// What all parameters of kernels have that look into a table of a function.
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
    /// What was sent is not what is wanted any more.
    void invalidate() { is_sent_ = false; }
    /// Its handle; sends `texels` where they are not there yet.
    Resource upload(FrameGraph& graph, std::span<const glm::vec4> texels);

private:
    gpu::Memory& memory_;
    std::string name_;
    gpu::Storage image_;
    bool is_sent_ = false;
};

/// The tables of a scene: of its transfer function, and of its groups. One thread, the renderer's.
class LookTables {
public:
    explicit LookTables(gpu::Memory& memory)
        : function_on_device_(memory, "transfer function"), groups_on_device_(memory, "groups")
    {}

    /// For steps of that many reference lengths.
    const LookTable& table_of(const Look& look, double step_voxels);
    /// What may be seen, for whichever length of steps there is a table: it does not depend on that.
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

#pragma once
// A transfer function as the device reads it: a table for one length of step, plain or pre-integrated, and which stretches of
// it show anything. Baked in double on the CPU, kept as long as it is the same.

#include <span>
#include <vector>

#include "engine/scene/session.h"
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
    bool is_of(const Session& session, double step) const;
};

LookTable make_look_table(const Session& session, double step_voxels);

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

}  // namespace shvr

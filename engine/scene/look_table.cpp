#include "engine/scene/look_table.h"

#include <algorithm>

#include "engine/scene/preintegration.h"

namespace shvr {

TableMap table_map(const TransferFunction& function, const IntensityWindow& window, uint32_t entries)
{
    const double lower = window.code_of(function.lower()), upper = window.code_of(function.upper());
    return {float(lower), float(upper), float((entries - 1) / std::max(upper - lower, 1e-6))};
}

bool LookTable::is_of(const Session& session, double step) const
{
    return step_voxels == step && preintegrated == session.render.preintegration &&
           std::ranges::equal(points, session.transfer_function.points());
}

LookTable make_look_table(const Session& session, double step_voxels)
{
    const std::span<const ControlPoint> points = session.transfer_function.points();
    LookTable table{.points = {points.begin(), points.end()},
                    .step_voxels = step_voxels,
                    .preintegrated = session.render.preintegration,
                    .texels = {},
                    .visible_intervals = {}};
    if (table.preintegrated) {
        table.texels = preintegrated_table(session.transfer_function, step_voxels, STEP_TABLE_SIDE);
        table.visible_intervals = visible_intervals_of_steps(table.texels, STEP_TABLE_SIDE);
    } else {
        table.texels = bake_table(session.transfer_function, step_voxels, TABLE_ENTRIES);
        table.visible_intervals = visible_intervals(table.texels);
    }
    return table;
}

}  // namespace shvr

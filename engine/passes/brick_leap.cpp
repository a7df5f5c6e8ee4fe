#include "engine/passes/brick_leap.h"

#include <algorithm>
#include <tuple>

#include "engine/passes/pixel_groups.h"

namespace shvr {

namespace {

/// Maximum number of bricks per dispatch, which bounds a dispatch's time on slow devices.
constexpr size_t BATCH = 2048;

}  // namespace

bool Visibility::shows(double lower_code, double upper_code) const
{
    const double lower = double(params.table_lower), upper = double(params.table_upper);
    if (params.skipping == 0) return true;
    // Adds one code on each side of the kernels' guard, so that no visible code is excluded.
    const double beside = 1.0 + double(params.guard), from = lower_code - beside, to = upper_code + beside;
    if (params.table_entries < 2 || to < lower || from > upper) return false;
    const double last = double(params.table_entries - 1);
    const auto interval = [&](double code) {
        return size_t(std::clamp((code - lower) * double(params.table_scale), 0.0, last - 1.0));
    };
    return visible_intervals[interval(to) + 1] > visible_intervals[interval(from)];
}

bool operator==(const Visibility& a, const Visibility& b)
{
    const auto members = [](const Visibility& v) {
        return std::tie(v.params.table_lower, v.params.table_upper, v.params.table_scale, v.params.table_entries,
                        v.params.guard, v.params.skipping, v.params.paint_reach, v.visible_intervals, v.visible_groups);
    };
    return members(a) == members(b);
}

void brick_leap(FrameGraph& graph, VolumeBinding& volume, const Visibility& visibility,
                const std::optional<MaskBinding>& mask, std::span<const gpu::BrickLeapJob> jobs)
{
    graph.expect({variant_of("brick_leap", {{"MASKED", true}}), {}});  // needed once something is painted
    for (size_t first = 0; first < jobs.size(); first += BATCH) {
        const std::span<const gpu::BrickLeapJob> batch = jobs.subspan(first, std::min(BATCH, jobs.size() - first));
        Pass pass = graph.compute("brick_leap", {{"MASKED", mask.has_value()}});
        pass.read("cell_ranges", volume.cell_ranges);
        pass.block("jobs", batch);
        pass.block("visible_intervals", std::span<const uint32_t>(visibility.visible_intervals));
        if (mask) {
            pass.read("mask", mask->mask);
            pass.read("mask_table", mask->mask_table);
            pass.block("visible_groups", std::span<const uint32_t>(visibility.visible_groups));
        }
        pass.push(visibility.params);
        group_each(pass, batch.size());
        volume.pages->cell_leap = pass.write("cell_leap", volume.pages->cell_leap);
    }
}

}  // namespace shvr

#include "engine/device/empty_space.h"

#include <tuple>
#include <utility>

namespace shvr {

namespace {

bool shows_the_same(const LeapGridInput& a, const LeapGridInput& b)
{
    const auto members = [](const LeapGridInput& look) {
        const gpu::OccupancyParams& p = look.params;
        return std::tie(p.brick_counts, p.table_lower, p.table_upper, p.table_scale, p.table_entries, p.guard,
                        p.skipping, p.paint_reach, look.visible_intervals, look.visible_groups);
    };
    return members(a) == members(b);
}

CellBox united(const CellBox& a, const CellBox& b)
{
    if (a.empty()) return b;
    return b.empty() ? a : CellBox{glm::min(a.begin, b.begin), glm::max(a.end, b.end)};
}

}  // namespace

void EmptySpace::changed(const CellBox& cells)
{
    if (!look_) return;
    if (holds_) patch_ = united(patch_, cells);
    changed_ = stage_ == LEAP_STAGES ? cells : united(changed_, cells);
    stage_ = 0;
}

void EmptySpace::want(const LeapGridInput& look, const glm::uvec3& cell_counts)
{
    if (look_ && shows_the_same(*look_, look)) return;
    look_ = look;
    look_->mask.reset();  // the mask's handles are valid in one graph only, so they are not kept
    holds_ = false;
    patch_ = {};
    stage_ = 0;
    cell_counts_ = cell_counts;
    changed_ = {glm::uvec3(0), cell_counts};
}

void EmptySpace::forget_unless_submitted(FrameGraph& graph)
{
    graph.unless_submitted([this] {
        holds_ = false;
        patch_ = {};
        stage_ = 0;
        changed_ = {glm::uvec3(0), cell_counts_};
    });
}

void EmptySpace::prepare(FrameGraph& graph, VolumeBinding& volume, LeapGridInput look)
{
    SHVR_CHECK(is_due());
    forget_unless_submitted(graph);
    if (!holds_) {
        look.changed = changed_;
        leap_grid_stage(graph, volume, look, stage_++);
        holds_ = stage_ == LEAP_STAGES;
        return;
    }
    look.changed = std::exchange(patch_, {});
    leap_grid_patch(graph, volume, look);
}

void EmptySpace::refine(FrameGraph& graph, VolumeBinding& volume, LeapGridInput look)
{
    SHVR_CHECK(is_worth_refining());
    forget_unless_submitted(graph);
    look.changed = changed_;
    leap_grid_stage(graph, volume, look, stage_++);
    if (stage_ == LEAP_STAGES) patch_ = {};
}

}  // namespace shvr

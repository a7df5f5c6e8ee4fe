#include "engine/device/look_table.h"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/look/preintegration.h"

namespace shvr {

namespace {

std::array<uint32_t, 8> visible_groups(const Groups& groups)
{
    std::array<uint32_t, 8> bits{};
    for (uint32_t group = 1; group < 256; ++group) {
        const ColorGroup look = group_of(groups, uint8_t(group));
        if (look.visible && look.opacity > 0.0) bits[group / 32] |= 1u << group % 32;
    }
    return bits;
}

}  // namespace

TableMap table_map(const TransferFunction& function, const IntensityWindow& window, uint32_t entries)
{
    const double lower = window.code_of(function.lower()), upper = window.code_of(function.upper());
    return {float(lower), float(upper), float((entries - 1) / std::max(upper - lower, 1e-6))};
}

bool LookTable::is_of(const TransferFunction& function, double step, bool is_preintegrated) const
{
    return step_voxels == step && preintegrated == is_preintegrated && std::ranges::equal(points, function.points());
}

LookTable make_look_table(const TransferFunction& function, double step_voxels, bool is_preintegrated)
{
    const std::span<const ControlPoint> points = function.points();
    LookTable table{.points = {points.begin(), points.end()},
                    .step_voxels = step_voxels,
                    .preintegrated = is_preintegrated,
                    .texels = {},
                    .visible_intervals = {}};
    if (table.preintegrated) {
        table.texels = preintegrated_table(function, step_voxels, STEP_TABLE_SIDE);
        table.visible_intervals = visible_intervals_of_steps(table.texels, STEP_TABLE_SIDE);
    } else {
        table.texels = bake_table(function, step_voxels, TABLE_ENTRIES);
        table.visible_intervals = visible_intervals(table.texels);
    }
    return table;
}

std::vector<glm::vec4> make_group_looks(const Groups& groups, double step_voxels)
{
    std::vector<glm::vec4> looks(256);
    for (uint32_t group = 1; group < 256; ++group) {
        const ColorGroup look = group_of(groups, uint8_t(group));
        const double opacity = look.visible ? opacity_of_step(look.opacity, step_voxels) : 0.0;
        looks[group] = glm::vec4(glm::vec3(look.color), float(opacity));
    }
    return looks;
}

Resource DeviceTable::upload(FrameGraph& graph, std::span<const glm::vec4> texels)
{
    const uint32_t width = gpu::TABLE_WIDTH;
    const ResourceDesc desc = image_desc(Format::rgba32_float, {width, uint32_t(texels.size()) / width, 1});
    if (!image_ || image_.desc() != desc) {
        image_.reset();
        image_ = memory_.create(name_, desc);
        is_sent_ = false;
    }
    const Resource on_device = graph.import(name_, image_.import());
    if (std::exchange(is_sent_, true)) return on_device;
    return graph.copy_to_image(graph.upload<glm::vec4>(name_ + " entries", texels), on_device,
                               {{0, glm::uvec3(0), desc.texels}}, "upload " + name_);
}

const LookTable& LookTables::table_of(const Look& look, double step_voxels)
{
    if (table_ && table_->is_of(look.transfer_function, step_voxels, look.render.preintegration)) return *table_;
    table_ = make_look_table(look.transfer_function, step_voxels, look.render.preintegration);
    function_on_device_.invalidate();
    return *table_;
}

Visibility LookTables::visibility_of(const Look& look, const IntensityWindow& window)
{
    const LookTable& table = table_of(look, table_ ? table_->step_voxels : look.render.step_voxels);
    Visibility visibility{.params = {.skipping = look.render.skip_empty_space},
                          .visible_intervals = table.visible_intervals,
                          .visible_groups = visible_groups(look.groups)};
    set_table(visibility.params, look.transfer_function, window, table.entries());
    return visibility;
}

Resource LookTables::upload_function(FrameGraph& graph, const Look& look, double step_voxels)
{
    const LookTable& table = table_of(look, step_voxels);
    return function_on_device_.upload(graph, table.texels);
}

Resource LookTables::upload_groups(FrameGraph& graph, const Look& look, double step_voxels)
{
    std::vector<glm::vec4> groups = make_group_looks(look.groups, step_voxels);
    if (groups != groups_) groups_on_device_.invalidate();
    groups_ = std::move(groups);
    return groups_on_device_.upload(graph, groups_);
}

}  // namespace shvr

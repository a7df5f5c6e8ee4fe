#include "engine/device/look_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/look/preintegration.h"

namespace shvr {

namespace {

constexpr double LAST_CODE = 65535.0;
/// A sloped segment can be interpolated in a small table if its opacity is below this value at both ends.
constexpr double MAX_SLOPED = 0.999;

uint32_t whole_rows(uint32_t texels)
{
    return (texels + gpu::TABLE_WIDTH - 1) / gpu::TABLE_WIDTH * gpu::TABLE_WIDTH;
}

void fill_row(std::vector<glm::vec4>& texels)
{
    texels.resize(whole_rows(uint32_t(texels.size())), glm::vec4(0.0f));
}

/// Four entries per texel.
void append_depths(std::vector<glm::vec4>& texels, std::span<const float> depths)
{
    for (size_t entry = 0; entry < depths.size(); ++entry) {
        if (entry % 4 == 0) texels.emplace_back(0.0f);
        texels.back()[int(entry % 4)] = depths[entry];
    }
}

/// Appends a texel per entry: the optical depth at the entry, and at the next entries along front, back and both.
void append_depths_of_steps(std::vector<glm::vec4>& texels, std::span<const float> depths)
{
    const uint32_t side = STEP_TABLE_SIDE;
    for (uint32_t back = 0; back < side; ++back)
        for (uint32_t front = 0; front < side; ++front) {
            const size_t next_front = std::min(front + 1, side - 1), next_back = std::min(back + 1, side - 1);
            texels.emplace_back(depths[size_t(back) * side + front], depths[size_t(back) * side + next_front],
                                depths[next_back * side + front], depths[next_back * side + next_front]);
        }
}

/// The points as gpu::RaycastParams::points describes them.
void append_points(std::vector<glm::vec4>& texels, std::span<const ControlPoint> points, const IntensityWindow& window)
{
    for (const ControlPoint& point : points) texels.emplace_back(glm::vec3(point.color), float(point.opacity));
    for (const ControlPoint& point : points)
        texels.emplace_back(float(window.code_of(point.intensity)), 0.0f, 0.0f, 0.0f);
}

/// The smallest multiple of `parts` that is at least MIN_TABLE_ENTRIES - 1; a table has one more entry than parts.
uint32_t parts_of_at_least(uint32_t parts)
{
    return parts * ((MIN_TABLE_ENTRIES - 2) / parts + 1);
}

/// Whether interpolation between the entries of a fine table reproduces the function, provided control points are at
/// entries.
bool has_smooth_lines(const TransferFunction& function)
{
    const std::span<const ControlPoint> points = function.points();
    for (size_t i = 0; i + 1 < points.size(); ++i) {
        const ControlPoint &p = points[i], &q = points[i + 1];
        if (p == q) continue;
        if (p.intensity == q.intensity) return false;
        // Opacity that rises up to 1 makes the opacity of a step too steep to be interpolated.
        if (std::max(p.opacity, q.opacity) >= MAX_SLOPED && p.opacity != q.opacity) return false;
    }
    return true;
}

/// A number of entries that fits into fast memory and puts each control point at an entry; null if this is impossible.
std::optional<uint32_t> entries_at_points(const TransferFunction& function, const IntensityWindow& window,
                                          const TableRange& range)
{
    if (!has_smooth_lines(function) || !(range.lower < range.upper)) return std::nullopt;
    int64_t between = 0;  // greatest common divisor of all distances between points, in codes
    bool are_whole = true;
    bool are_inside = false;
    for (const ControlPoint& point : function.points()) {
        const double from_lower = window.code_of(point.intensity) - range.lower;
        if (from_lower <= 0.0 || from_lower >= range.upper - range.lower) continue;
        are_inside = true;
        are_whole = are_whole && std::abs(from_lower - std::round(from_lower)) < 1e-6;
        between = std::gcd(between, int64_t(std::round(from_lower)));
    }
    if (!are_inside) return MIN_TABLE_ENTRIES;
    const double width = range.upper - range.lower;
    if (!are_whole || width < 1.0 || std::abs(width - std::round(width)) > 1e-6) return std::nullopt;
    const int64_t parts = int64_t(std::round(width)) / std::gcd(between, int64_t(std::round(width)));
    const uint32_t entries = parts_of_at_least(uint32_t(parts)) + 1;
    if (entries > 2 * MIN_TABLE_ENTRIES) return std::nullopt;
    return entries;
}

float opaque_scale(const TableRange& range)
{
    return float((gpu::OPAQUE_ENTRIES - 1) / std::max(range.upper - range.lower, 1e-6));
}

/// Appends the map of opaque intervals, then the intervals; appends nothing if `intervals` is empty.
void append_opaque(std::vector<glm::vec4>& texels, const std::vector<OpaqueInterval>& intervals,
                   const TableRange& range, const IntensityWindow& window)
{
    if (intervals.empty()) return;
    struct Codes {
        double lower, upper;
    };
    std::vector<Codes> codes{{-gpu::OUT_OF_REACH, -gpu::OUT_OF_REACH}};
    for (const OpaqueInterval& interval : intervals)
        codes.push_back({window.code_of(interval.lower), window.code_of(interval.upper)});
    codes.push_back({gpu::OUT_OF_REACH, gpu::OUT_OF_REACH});
    // Adds a margin of half a texel on both sides, since kernels compute the texel of a density in float.
    const double width = (range.upper - range.lower) / (gpu::OPAQUE_ENTRIES - 1);
    size_t first = 0, last = 0;
    for (uint32_t k = 0; k < gpu::OPAQUE_ENTRIES; ++k) {
        const double lower = range.lower + width * (k - 0.5), upper = range.lower + width * (k + 1.5);
        while (codes[first].upper < lower) ++first;
        while (last + 1 < codes.size() && codes[last + 1].lower <= upper) ++last;
        texels.emplace_back(float(first), float(last), 0.0f, 0.0f);
    }
    for (size_t i = 0; i < codes.size(); ++i) {
        const bool is_real = i > 0 && i + 1 < codes.size();
        const OpaqueInterval interval = is_real ? intervals[i - 1] : OpaqueInterval{};
        texels.emplace_back(interval.lower_color, codes[i].lower);
        texels.emplace_back(interval.upper_color, codes[i].upper);
    }
}

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

TableRange table_range(const TransferFunction& function, const IntensityWindow& window, bool is_preintegrated)
{
    const double first = window.code_of(function.lower()), last = window.code_of(function.upper());
    TableRange range{
        .lower = std::clamp(first, 0.0, LAST_CODE), .upper = std::clamp(last, 0.0, LAST_CODE), .samples = {}};
    // If nothing is cut off, keeps the function's own bounds: they are more exact than bounds computed from codes.
    range.samples.lower = range.lower == first ? function.lower() : window.intensity_of(range.lower);
    range.samples.upper = range.upper == last ? function.upper() : window.intensity_of(range.upper);
    const auto codes = std::max(uint32_t(std::ceil(range.upper - range.lower)), 1u);
    range.samples.entries = is_preintegrated
                                ? STEP_TABLE_SIDE
                                : entries_at_points(function, window, range).value_or(parts_of_at_least(codes) + 1);
    return range;
}

bool LookTable::is_of(const TransferFunction& function, const RenderSettings& render, double step,
                      const Samples& of) const
{
    return step_voxels == step && preintegrated == render.classifies_steps() && has_points == render.exact_integral &&
           samples == of && std::ranges::equal(points, function.points());
}

LookTable make_look_table(const TransferFunction& function, const IntensityWindow& window, double step_voxels,
                          bool is_preintegrated, bool has_points)
{
    const std::span<const ControlPoint> points = function.points();
    const TableRange range = table_range(function, window, is_preintegrated);
    LookTable table{.points = {points.begin(), points.end()},
                    .step_voxels = step_voxels,
                    .preintegrated = is_preintegrated,
                    .has_points = has_points,
                    .samples = range.samples,
                    .texels = {},
                    .visible_intervals = {}};
    if (is_preintegrated) {
        BakedTable baked = preintegrated_table(function, step_voxels, range.samples);
        const std::vector<OpaqueInterval> opaque = opaque_intervals(function);
        table.visible_intervals = visible_intervals_of_steps(baked.looks, range.samples, opaque);
        table.texels = std::move(baked.looks);
        append_depths_of_steps(table.texels, baked.depths);
        append_opaque(table.texels, opaque, range, window);
    } else {
        BakedTable baked = bake_table(function, step_voxels, range.samples);
        table.visible_intervals =
            has_points ? visible_intervals(function, range.samples) : visible_intervals(baked.looks);
        table.texels = std::move(baked.looks);
        fill_row(table.texels);
        append_depths(table.texels, baked.depths);
    }
    fill_row(table.texels);
    if (has_points) append_points(table.texels, points, window);
    fill_row(table.texels);
    return table;
}

void set_look_table(gpu::RaycastParams& params, const TransferFunction& function, const IntensityWindow& window,
                    bool is_preintegrated, bool has_points)
{
    const TableRange range = table_range(function, window, is_preintegrated);
    set_table(params, range);
    const uint32_t side = STEP_TABLE_SIDE, entries = range.samples.entries;
    params.table_depths = is_preintegrated ? side * side : whole_rows(entries);
    params.opaque_map = is_preintegrated && !opaque_intervals(function).empty() ? 2 * side * side : 0;
    params.opaque_scale = opaque_scale(range);
    if (!has_points) return;
    params.points = params.table_depths + whole_rows((entries + 3) / 4);
    params.point_count = uint32_t(function.points().size());
}

std::vector<glm::vec4> make_group_looks(const Groups& groups, double step_voxels)
{
    std::vector<glm::vec4> looks(512);
    for (uint32_t group = 1; group < 256; ++group) {
        const ColorGroup look = group_of(groups, uint8_t(group));
        const double depth = look.visible ? depth_of_step(look.opacity, step_voxels) : 0.0;
        looks[group] = glm::vec4(glm::vec3(look.color), float(-std::expm1(-depth)));
        looks[256 + group].x = float(std::min(depth, double(gpu::OPAQUE_DEPTH)));
    }
    return looks;
}

Resource DeviceTable::upload(FrameGraph& graph, std::span<const glm::vec4> texels)
{
    const uint32_t width = gpu::TABLE_WIDTH;
    const ResourceDesc desc = picture_desc(Format::rgba32_float, {width, uint32_t(texels.size()) / width});
    if (!image_ || image_.desc() != desc) {
        image_.reset();
        image_ = memory_.create(name_, desc);
        is_sent_ = false;
    }
    const Resource on_device = graph.import(name_, image_.import());
    if (std::exchange(is_sent_, true)) return on_device;
    graph.unless_submitted([this] { is_sent_ = false; });
    return graph.copy_to_image(graph.upload<glm::vec4>(name_ + " entries", texels), on_device,
                               {{0, glm::uvec3(0), desc.texels}}, "upload " + name_);
}

const LookTable& LookTables::table_of(const Look& look, const IntensityWindow& window, double step_voxels)
{
    const bool is_preintegrated = look.render.classifies_steps();
    const Samples samples = table_range(look.transfer_function, window, is_preintegrated).samples;
    if (table_ && table_->is_of(look.transfer_function, look.render, step_voxels, samples)) return *table_;
    table_ = make_look_table(look.transfer_function, window, step_voxels, is_preintegrated, look.render.exact_integral);
    function_on_device_.invalidate();
    return *table_;
}

Visibility LookTables::visibility_of(const Look& look, const IntensityWindow& window)
{
    const LookTable& table = table_of(look, window, table_ ? table_->step_voxels : look.render.step_voxels);
    Visibility visibility{
        .params = {.skipping = look.render.skip_empty_space, .paint_reach = look.render.smooth_borders},
        .visible_intervals = table.visible_intervals,
        .visible_groups = visible_groups(look.groups)};
    set_table(visibility.params, table_range(look.transfer_function, window, table.preintegrated));
    return visibility;
}

Resource LookTables::upload_function(FrameGraph& graph, const Look& look, const IntensityWindow& window,
                                     double step_voxels)
{
    const LookTable& table = table_of(look, window, step_voxels);
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

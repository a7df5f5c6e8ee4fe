#include "engine/scene/renderer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <thread>
#include <tuple>
#include <utility>

namespace shvr {

namespace {

/// Pixels of one dispatch: bounds what a single submission costs on a slow device.
constexpr glm::uvec2 TILE{128, 128};

double reference_length(const VolumeInfo& info)
{
    return std::min({info.spacing.x, info.spacing.y, info.spacing.z});
}

/// The direction towards the light in volume space. Lights move with the camera.
glm::dvec3 light_direction(const Light& light, const Camera& camera)
{
    const glm::dvec3 over_the_shoulder(0.3, 0.5, 1.0);
    const glm::dvec3 local = light.direction == glm::dvec3(0.0) ? over_the_shoulder : light.direction;
    const glm::dvec3 back = glm::normalize(camera.eye - camera.target);
    const glm::dvec3 right = glm::normalize(glm::cross(camera.up, back));
    const glm::dvec3 up = glm::cross(back, right);
    return glm::normalize(local.x * right + local.y * up + local.z * back);
}

struct TableMap {
    float lower, upper, scale;
};

/// Table coordinate = (code - lower) * scale.
TableMap table_map(const TransferFunction& function, const IntensityWindow& window)
{
    const double lower = window.code_of(function.lower()), upper = window.code_of(function.upper());
    return {float(lower), float(upper), float((TABLE_ENTRIES - 1) / std::max(upper - lower, 1e-6))};
}

std::array<uint32_t, 8> visible_groups(const Session& session)
{
    std::array<uint32_t, 8> bits{};
    for (uint32_t group = 1; group < 256; ++group) {
        const ColorGroup look = group_of(session, uint8_t(group));
        if (look.visible && look.opacity > 0.0) bits[group / 32] |= 1u << group % 32;
    }
    return bits;
}

std::vector<gpu::GroupLook> group_looks(const Session& session)
{
    std::vector<gpu::GroupLook> looks(256);
    for (uint32_t group = 1; group < 256; ++group) {
        const ColorGroup look = group_of(session, uint8_t(group));
        const double opacity = look.visible ? opacity_of_step(look.opacity, session.render.step_voxels) : 0.0;
        looks[group] = {glm::vec3(look.color), float(opacity)};
    }
    return looks;
}

gpu::RaycastParams raycast_params(const Session& session, const Camera& camera, const DeviceVolume& volume,
                                  const VolumeBinding& binding, const VolumeStatistics& statistics,
                                  const PicturePart& part)
{
    const VolumeInfo& info = volume.info();
    const RayPlanes planes = ray_planes(camera, part.pixels, info);
    const TableMap map = table_map(session.transfer_function, volume.window());
    const double codes_range = (statistics.range().upper - statistics.range().lower) * volume.window().codes_per_unit;
    const glm::vec3 size(info.size);
    const glm::vec3 last(std::nextafter(size.x, 0.0f), std::nextafter(size.y, 0.0f), std::nextafter(size.z, 0.0f));
    gpu::RaycastParams params{};
    params.near_corner = planes.near_corner;
    params.near_dx = planes.near_dx;
    params.near_dy = planes.near_dy;
    params.far_corner = planes.far_corner;
    params.far_dx = planes.far_dx;
    params.far_dy = planes.far_dy;
    params.pixel_begin = part.begin;
    params.pixel_end = part.end;
    params.target = part.target;
    params.box_lower = glm::max(glm::vec3(session.cut.lower), glm::vec3(0.0f));
    params.box_upper = glm::min(glm::vec3(session.cut.upper), size);
    params.position_limit = last;
    const bool cut_away = glm::any(glm::greaterThan(params.box_lower, params.box_upper));
    if (planes.empty || cut_away) params.box_upper = params.box_lower = glm::vec3(-1.0f);
    params.spacing = info.spacing / reference_length(info);
    params.inverse_spacing = reference_length(info) / info.spacing;
    params.cell_counts = binding.cell_counts;
    params.brick_counts = binding.brick_counts;
    params.step = float(session.render.step_voxels);
    params.opacity_limit = float(session.render.opacity_limit);
    params.table_lower = map.lower;
    params.table_upper = map.upper;
    params.table_scale = map.scale;
    params.table_entries = TABLE_ENTRIES;
    params.background = session.render.background;
    params.light = light_direction(session.light, camera);
    params.ambient = float(session.light.ambient);
    params.diffuse = float(session.light.diffuse);
    params.specular = float(session.light.specular);
    params.shininess = float(session.light.shininess);
    params.gradient_fade = float(session.light.gradient_fade * codes_range);
    if (part.probe) {
        params.probe_center = part.probe->center / info.spacing;
        params.probe_radius = float(part.probe->radius / reference_length(info));
        params.probe_color = part.probe->color;
    }
    return params;
}

int worker_count(int wanted)
{
    return wanted > 0 ? wanted : std::max(1, int(std::thread::hardware_concurrency()));
}

}  // namespace

bool Renderer::LeapState::operator==(const LeapState& other) const
{
    const auto members = [](const LeapState& state) {
        const gpu::OccupancyParams& p = state.params;
        return std::tie(p.brick_counts, p.table_lower, p.table_upper, p.table_scale, p.table_entries, p.skipping,
                        state.visible_intervals, state.visible_groups);
    };
    return members(*this) == members(other);
}

Renderer::Renderer(const Options& options)
    : device_(options.device),
      memory_(device_, options.budget),
      executor_(device_, memory_),
      threads_(worker_count(options.threads)),
      mask_(executor_, memory_)
{}

bool Renderer::filters(Sampling sampling) const
{
    const gpu::DeviceTraits& traits = device_.traits();
    if (sampling == Sampling::hardware && !traits.linear_r16)
        fail("render.sampling is hardware; device ", traits.name,
             " cannot filter R16_UNORM, expected automatic or exact");
    // A CPU filters slower than it loads and computes; a GPU's sampler is nearly free.
    return sampling == Sampling::hardware || (sampling == Sampling::automatic && !traits.is_cpu && traits.linear_r16);
}

void Renderer::load(const VolumeSource& source, const VolumeStatistics& statistics, Sampling sampling)
{
    const IntensityWindow window = window_for(source.info().type, statistics.range().lower, statistics.range().upper);
    volume_.reset();
    leap_state_.reset();
    mask_.clear();  // paint belongs to the volume it was painted on
    statistics_ = statistics;
    volume_.emplace(executor_, memory_, source, window, filters(sampling), threads_);
}

const DeviceVolume& Renderer::volume() const
{
    SHVR_CHECK(volume_.has_value());
    return *volume_;
}

void Renderer::update_mask(const Mask& mask, std::span<const int64_t> bricks)
{
    mask_.update(mask, bricks);
    if (bricks.empty() || !leap_state_) return;
    CellBox changed = leap_stage_ == LEAP_STAGES ? CellBox{glm::uvec3(~0u), glm::uvec3(0)} : leap_changed_;
    const glm::i64vec3 counts = mask.brick_counts();
    for (int64_t brick : bricks) {
        const glm::uvec3 first =
            gpu::BRICK_CELLS * glm::uvec3(brick % counts.x, brick / counts.x % counts.y, brick / (counts.x * counts.y));
        changed = {glm::min(changed.begin, first), glm::max(changed.end, first + gpu::BRICK_CELLS)};
    }
    leap_changed_ = changed;
    leap_stage_ = 0;
}

const Renderer::Table& Renderer::table_of(const Session& session)
{
    const std::span<const ControlPoint> points = session.transfer_function.points();
    if (baked_ && baked_->step_voxels == session.render.step_voxels && std::ranges::equal(baked_->points, points))
        return *baked_;
    baked_ = {.points = {points.begin(), points.end()},
              .step_voxels = session.render.step_voxels,
              .entries = bake_table(session.transfer_function, session.render.step_voxels, TABLE_ENTRIES),
              .visible_intervals = {}};
    baked_->visible_intervals = visible_intervals(baked_->entries);
    table_is_on_device_ = false;
    return *baked_;
}

Resource Renderer::upload_table(FrameGraph& graph, const Table& table)
{
    const ResourceDesc desc = image_desc(Format::rgba32_float, {gpu::TABLE_WIDTH, gpu::TABLE_HEIGHT, 1});
    if (!table_) table_ = memory_.create("transfer function", desc);
    const Resource on_device = graph.import("transfer function", table_.import());
    if (std::exchange(table_is_on_device_, true)) return on_device;
    return graph.copy_to_image(graph.upload<glm::vec4>("transfer function entries", table.entries), on_device,
                               {{0, glm::uvec3(0), desc.texels}}, "upload transfer function");
}

LeapGridInput Renderer::want_leap_grid(FrameGraph& graph, const VolumeBinding& volume, const Session& session)
{
    const Table& table = table_of(session);
    const TableMap map = table_map(session.transfer_function, volume_->window());
    LeapGridInput input;
    input.params = {.brick_counts = volume.brick_counts,
                    .table_lower = map.lower,
                    .table_upper = map.upper,
                    .table_scale = map.scale,
                    .table_entries = TABLE_ENTRIES,
                    .skipping = session.render.skip_empty_space,
                    .mask_slots = glm::uvec3(0)};
    input.visible_intervals = table.visible_intervals;
    input.visible_groups = visible_groups(session);
    LeapState state{input.params, input.visible_intervals, input.visible_groups};
    if (!mask_.empty()) {
        input.mask = mask_.import(graph);
        input.params.mask_slots = input.mask->slots;
    }
    if (!leap_state_ || !(*leap_state_ == state)) {
        leap_state_ = std::move(state);
        leap_stage_ = 0;
        leap_changed_ = {glm::uvec3(0), volume.cell_counts};
    }
    input.changed = leap_changed_;
    return input;
}

std::optional<FrameGraph> Renderer::next_preparation(const Session& session)
{
    FrameGraph graph;
    VolumeBinding volume = volume_.value().import(graph);
    const LeapGridInput leap = want_leap_grid(graph, volume, session);
    if (leap_stage_ == LEAP_STAGES) return std::nullopt;
    leap_grid_stage(graph, volume, leap, leap_stage_++);
    return graph;
}

RaycastInput Renderer::prepare(FrameGraph& graph, VolumeBinding& volume, const Session& session, const Camera& camera,
                               const PicturePart& part)
{
    RaycastInput input;
    input.params = raycast_params(session, camera, *volume_, volume, statistics_, part);
    const Table& table = table_of(session);
    input.table = upload_table(graph, table);
    input.shaded = session.light.shaded;
    input.group_width = device_.traits().is_cpu ? 16 : 8;
    input.tile = TILE;
    input.probe = part.probe.has_value();

    const LeapGridInput leap = want_leap_grid(graph, volume, session);
    while (leap_stage_ < LEAP_STAGES) leap_grid_stage(graph, volume, leap, leap_stage_++);
    if (leap.mask) {
        input.mask = leap.mask;
        input.params.mask_slots = leap.mask->slots;
        input.groups = group_looks(session);
    }
    return input;
}

Resource Renderer::draw(FrameGraph& graph, const Session& session, const Camera& camera, const PicturePart& part,
                        Resource target, bool count_work)
{
    VolumeBinding volume = volume_.value().import(graph);
    RaycastInput input = prepare(graph, volume, session, camera, part);
    input.count_work = count_work;
    return raycast(graph, volume, input, target);
}

Picture Renderer::render(const Session& session, const Camera& camera, const RenderOptions& options)
{
    Picture picture;
    const glm::uvec2 size = session.render.size;
    const Resource color = picture.graph.create("color", image_desc(Format::rgba32_float, glm::uvec3(size, 1)));
    const PicturePart whole{.pixels = size, .end = size, .probe = options.probe};
    const uint32_t pixels =
        picture.graph.read_back(draw(picture.graph, session, camera, whole, color, options.count_work));
    gpu::FrameResult result =
        executor_.run(picture.graph, {.timestamps = options.timestamps, .serialize = options.serialize});
    picture.image = {int(size.x), int(size.y), {}};
    picture.image.rgba.resize(result.read_backs[pixels].size() / sizeof(float));
    std::memcpy(picture.image.rgba.data(), result.read_backs[pixels].data(), result.read_backs[pixels].size());
    picture.passes = std::move(result.passes);
    picture.wall_ms = result.wall_ms;
    return picture;
}

std::optional<glm::dvec3> Renderer::pick(const Session& session, const Camera& camera, const glm::uvec2& pixels,
                                         const glm::uvec2& pixel)
{
    FrameGraph graph;
    VolumeBinding volume = volume_.value().import(graph);
    RaycastInput input = prepare(graph, volume, session, camera, {.pixels = pixels, .begin = pixel, .end = pixel + 1u});
    input.pick = true;
    input.shaded = false;
    input.params.opacity_limit = std::min(input.params.opacity_limit, 0.5f);
    const Resource reached = graph.create("reached", image_desc(Format::rgba32_float, glm::uvec3(1)));
    const uint32_t index = graph.read_back(raycast(graph, volume, input, reached));
    const gpu::FrameResult result = executor_.run(std::move(graph), {.timestamps = false});
    glm::vec4 voxel_and_hit;
    std::memcpy(&voxel_and_hit, result.read_backs[index].data(), sizeof voxel_and_hit);
    if (voxel_and_hit.w == 0.0f) return std::nullopt;
    return glm::dvec3(voxel_and_hit) * volume_->info().spacing;
}

}  // namespace shvr

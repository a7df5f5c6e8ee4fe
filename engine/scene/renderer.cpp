#include "engine/scene/renderer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <thread>

#include "engine/passes/raycast.h"

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
                                  const VolumeBinding& binding, const VolumeStatistics& statistics)
{
    const VolumeInfo& info = volume.info();
    const RayPlanes planes = ray_planes(camera, session.render.size, info);
    const TableMap map = table_map(session.transfer_function, volume.window());
    const double codes_range = (statistics.maximum - statistics.minimum) * volume.window().codes_per_unit;
    const glm::vec3 size(info.size);
    const glm::vec3 last(std::nextafter(size.x, 0.0f), std::nextafter(size.y, 0.0f), std::nextafter(size.z, 0.0f));
    gpu::RaycastParams params{};
    params.near_corner = planes.near_corner;
    params.near_dx = planes.near_dx;
    params.near_dy = planes.near_dy;
    params.far_corner = planes.far_corner;
    params.far_dx = planes.far_dx;
    params.far_dy = planes.far_dy;
    params.pixels = session.render.size;
    params.box_lower = glm::max(glm::vec3(session.cut.lower), glm::vec3(0.0f));
    params.box_upper = glm::min(glm::vec3(session.cut.upper), size);
    params.position_limit = last;
    const bool cut_away = glm::any(glm::greaterThan(params.box_lower, params.box_upper));
    if (planes.empty || cut_away) params.box_upper = params.box_lower = glm::vec3(-1.0f);
    params.spacing = info.spacing / reference_length(info);
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
    return params;
}

bool same(const gpu::OccupancyParams& a, const gpu::OccupancyParams& b)
{
    return std::memcmp(&a, &b, sizeof a) == 0;  // scalar layout: no padding
}

int worker_count(int wanted)
{
    return wanted > 0 ? wanted : std::max(1, int(std::thread::hardware_concurrency()));
}

}  // namespace

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
    const IntensityWindow window = window_for(source.info().type, statistics.minimum, statistics.maximum);
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
    leap_state_.reset();
}

bool Renderer::leap_is_stale(const LeapGridInput& input) const
{
    return !leap_state_ || !same(leap_state_->params, input.params) ||
           leap_state_->visible_intervals != input.visible_intervals ||
           leap_state_->visible_groups != input.visible_groups;
}

Resource Renderer::upload_table(FrameGraph& graph, std::span<const glm::vec4> table)
{
    const ResourceDesc desc = image_desc(Format::rgba32_float, {gpu::TABLE_WIDTH, gpu::TABLE_HEIGHT, 1});
    if (!table_) {
        table_ = memory_.create("transfer function", desc);
        table_staging_ = memory_.create("transfer function staging", buffer_desc(desc.bytes), gpu::Placement::upload);
    }
    const Resource on_device = graph.import("transfer function", table_.import());
    if (std::equal(table.begin(), table.end(), table_on_device_.begin(), table_on_device_.end())) return on_device;
    std::memcpy(table_staging_.mapped().data(), table.data(), table.size_bytes());
    table_on_device_.assign(table.begin(), table.end());
    return graph.copy_to_image(graph.import("transfer function staging", table_staging_.import()), on_device,
                               {{0, glm::uvec3(0), desc.texels}}, "upload transfer function");
}

Picture Renderer::render(const Session& session, const Camera& camera, const RenderOptions& options)
{
    Picture picture;
    FrameGraph& graph = picture.graph;
    VolumeBinding volume = volume_.value().import(graph);

    RaycastInput input;
    input.params = raycast_params(session, camera, *volume_, volume, statistics_);
    const std::vector<glm::vec4> table =
        bake_table(session.transfer_function, session.render.step_voxels, TABLE_ENTRIES);
    input.table = upload_table(graph, table);
    input.shaded = session.light.shaded;
    input.count_work = options.count_work;
    input.group_width = device_.traits().is_cpu ? 16 : 8;
    input.tile = TILE;

    LeapGridInput leap;
    leap.params = {.cell_counts = volume.cell_counts,
                   .brick_counts = volume.brick_counts,
                   .table_lower = input.params.table_lower,
                   .table_upper = input.params.table_upper,
                   .table_scale = input.params.table_scale,
                   .table_entries = input.params.table_entries,
                   .skipping = session.render.skip_empty_space,
                   .mask_slots = glm::uvec3(0)};
    leap.visible_intervals = visible_intervals(table);
    if (!mask_.empty()) {
        input.mask = leap.mask = mask_.import(graph);
        input.params.mask_slots = leap.params.mask_slots = leap.mask->slots;
        input.groups = group_looks(session);
        leap.visible_groups = visible_groups(session);
    }
    const bool stale = leap_is_stale(leap);
    if (stale) volume.leap = leap_grid(graph, volume, leap);

    const uint32_t pixels = graph.read_back(raycast(graph, volume, input));
    gpu::FrameResult result = executor_.run(graph, {.timestamps = options.timestamps, .serialize = options.serialize});
    if (stale) leap_state_ = {leap.params, leap.visible_intervals, leap.visible_groups};
    picture.image = {int(session.render.size.x), int(session.render.size.y), {}};
    picture.image.rgba.resize(result.read_backs[pixels].size() / sizeof(float));
    std::memcpy(picture.image.rgba.data(), result.read_backs[pixels].data(), result.read_backs[pixels].size());
    picture.passes = std::move(result.passes);
    picture.wall_ms = result.wall_ms;
    return picture;
}

}  // namespace shvr

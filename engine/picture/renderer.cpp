#include "engine/picture/renderer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <thread>
#include <tuple>
#include <utility>

#include "engine/passes/anaglyph.h"
#include "engine/volume/grid.h"
#include "engine/volume/pyramid_source.h"

namespace shvr {

namespace {

/// Pixels of one dispatch: bounds what a single submission costs on a slow device.
constexpr glm::uvec2 TILE{128, 128};
/// More bricks than any view of a common screen needs: 27 000 of them.
constexpr uint64_t MOST_ATLAS_BYTES = uint64_t{2} << 30;

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

std::array<uint32_t, 8> visible_groups(const Session& session)
{
    std::array<uint32_t, 8> bits{};
    for (uint32_t group = 1; group < 256; ++group) {
        const ColorGroup look = group_of(session.groups, uint8_t(group));
        if (look.visible && look.opacity > 0.0) bits[group / 32] |= 1u << group % 32;
    }
    return bits;
}

/// What depends on the camera: rays, what they meet of the volume, light and depth.
void set_rays(gpu::RaycastParams& params, const Session& session, const Camera& camera, const VolumeInfo& info,
              const glm::uvec2& pixels)
{
    const RayPlanes planes = ray_planes(camera, pixels, info);
    params.near_corner = planes.near_corner;
    params.near_dx = planes.near_dx;
    params.near_dy = planes.near_dy;
    params.far_corner = planes.far_corner;
    params.far_dx = planes.far_dx;
    params.far_dy = planes.far_dy;
    params.box_lower = glm::max(glm::vec3(session.cut.lower), glm::vec3(0.0f));
    params.box_upper = glm::min(glm::vec3(session.cut.upper), glm::vec3(info.size));
    const bool cut_away = glm::any(glm::greaterThan(params.box_lower, params.box_upper));
    if (planes.empty || cut_away) params.box_upper = params.box_lower = glm::vec3(-1.0f);
    params.light = light_direction(session.light, camera);
    if (session.blend.size > 0.0)
        params.depth_plane = depth_plane(camera, params.box_lower, params.box_upper, info.spacing);
}

/// A slice shows the whole volume, whatever is cut away, in grey.
void set_slice(gpu::RaycastParams& params, const Session& session, const DeviceVolume& volume,
               const VolumeStatistics& statistics)
{
    const auto [lower, upper] = statistics.range();
    const SliceSettings& slices = session.view.slices;
    const double black = volume.window().code_of(slices.black.value_or(lower));
    const double white = volume.window().code_of(slices.white.value_or(upper));
    params.slice_black = float(black);
    params.slice_scale = float(1.0 / std::max(white - black, 1e-6));
    params.slice_paint = float(slices.paint_share);
    params.box_lower = glm::vec3(0.0f);
    params.box_upper = glm::vec3(volume.info().size);
    params.blend_size = 0.0f;
}

void set_shell(RaycastInput& input, const ProbeLook& probe, const DeviceVolume& volume)
{
    if (!probe.shell || !(probe.shell->opacity > 0.0)) return;
    const glm::dvec3& spacing = volume.info().spacing;
    input.shell = probe.shell->is_box ? gpu::SHELL_BOX : gpu::SHELL_BALL;
    input.params.shell_center = probe.center / spacing;
    input.params.shell_reach = probe.radius / spacing;
    input.params.shell_code = float(volume.window().code_of(probe.shell->threshold));
    input.params.shell_color = probe.color;
    input.params.shell_opacity = float(probe.shell->opacity);
}

/// `step_voxels`: between samples, in reference lengths.
gpu::RaycastParams raycast_params(const Session& session, const Camera& camera, const DeviceVolume& volume,
                                  const VolumeBinding& binding, const PicturePart& part, double step_voxels)
{
    const VolumeInfo& info = volume.info();
    const glm::vec3 size(info.size);
    const glm::vec3 last(std::nextafter(size.x, 0.0f), std::nextafter(size.y, 0.0f), std::nextafter(size.z, 0.0f));
    gpu::RaycastParams params{};
    params.pixel_begin = part.begin;
    params.pixel_end = part.end;
    params.target = part.target;
    params.position_limit = last;
    set_rays(params, session, camera, info, part.pixels);
    params.spacing = info.spacing / reference_length(info);
    params.inverse_spacing = reference_length(info) / info.spacing;
    if (binding.pages) {
        params.page_counts = binding.pages->counts;
        params.page_shift = binding.pages->cell_shift;
        params.page_depth = binding.pages->depth;
    }
    params.step = float(step_voxels);
    params.opacity_limit = float(session.render.opacity_limit);
    const uint32_t entries = session.render.preintegration ? STEP_TABLE_SIDE : TABLE_ENTRIES;
    set_table(params, session.transfer_function, volume.window(), entries);
    params.background = session.render.background;
    params.ambient = float(session.light.ambient);
    params.diffuse = float(session.light.diffuse);
    params.specular = float(session.light.specular);
    params.shininess = float(session.light.shininess);
    if (session.blend.size > 0.0) {
        params.blend_color = session.blend.color.value_or(glm::dvec3(session.render.background));
        params.blend_size = float(session.blend.size);
        params.blend_rate = float(session.blend.rate);
    }
    return params;
}

int worker_count(int wanted)
{
    return wanted > 0 ? wanted : std::max(1, int(std::thread::hardware_concurrency()));
}

}  // namespace

glm::dvec3 probe_color(const Session& session, uint8_t group)
{
    return group == 0 ? glm::dvec3(0.5) : group_of(session.groups, group).color;
}

std::optional<ProbeLook> shown_probe(const Session& session, const VolumeInfo& volume,
                                     const VolumeStatistics& statistics)
{
    const ProbeSettings& probe = session.probe;
    if (!probe.shown && !probe.shell && !probe.preview) return std::nullopt;
    ProbeLook look{.center = probe.voxel.value_or(0.5 * glm::dvec3(volume.size)) * volume.spacing,
                   .radius = probe.brush.radius_voxels * volume.spacing.x,
                   .color = probe_color(session, probe.brush.group),
                   .ball_share = !probe.shown                   ? 0.0
                                 : probe.shell || probe.preview ? BALL_IN_SHELL
                                                                : 1.0};
    if (probe.shell)
        look.shell = ShellLook{
            .threshold = probe.brush.threshold.value_or(automatic_threshold(session.transfer_function, statistics)),
            .opacity = probe.shell_opacity,
            .is_box = probe.brush.region == RegionShape::box};
    return look;
}

Renderer::Renderer(const Options& options)
    : device_(options.device),
      host_budget_(options.budget.host_bytes > 0 ? options.budget.host_bytes : uint64_t{2} << 30),
      memory_(device_, {options.budget.device_bytes, host_budget_ / 2}),
      executor_(device_, memory_),
      threads_(worker_count(options.threads)),
      mask_(executor_, memory_),
      occlusion_(memory_),
      surfaces_(memory_)
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

bool Renderer::pages(const VolumeSource& source, Paging paging, bool with_occlusion) const
{
    if (paging != Paging::automatic) return paging == Paging::always;
    if (source.levels() > 1) return true;
    // What pictures need beside the volume must find room, too.
    const uint64_t bytes = ResidentVolume::bytes_for(source.info());
    return (with_occlusion ? 2 * bytes : bytes) > memory_.device_bytes_left() / 16 * 15;
}

void Renderer::load(std::shared_ptr<const VolumeSource> source, const VolumeStatistics& statistics,
                    const RenderSettings& settings, bool with_occlusion)
{
    const IntensityWindow window = window_for(source->info().type, statistics);
    occlusion_.clear();
    occlusion_.set_drawn(nullptr);
    occlusion_has_no_room_ = false;
    surfaces_.set({});
    volume_.reset();
    offsets_.reset();
    resident_ = nullptr;
    paged_ = nullptr;
    empty_space_.forget();
    statistics_ = statistics;
    const bool filtered = filters(settings.sampling);
    const bool comes_and_goes = pages(*source, settings.paging, with_occlusion);
    mask_.clear(comes_and_goes);  // paint belongs to the volume it was painted on
    if (!comes_and_goes) {
        offsets_ = std::make_shared<OffsetSource>(std::move(source));
        auto volume = std::make_unique<ResidentVolume>(executor_, memory_, *offsets_, window, filtered, threads_);
        resident_ = volume.get();
        volume_ = std::move(volume);
        return;
    }
    const PagedVolume::Options options{
        .filtered = filtered,
        .threads = threads_,
        .host_bytes = host_budget_ / 4,
        .device_bytes = std::min(MOST_ATLAS_BYTES, memory_.device_bytes_left() / 5 * (with_occlusion ? 2 : 3))};
    offsets_ = std::make_shared<OffsetSource>(with_levels(std::move(source), host_budget_));
    auto volume = std::make_unique<PagedVolume>(executor_, memory_, offsets_, window, options);
    paged_ = volume.get();
    volume_ = std::move(volume);
    occlusion_.set_drawn([this](const BrickKey& key) { return paged_->is_drawn(key); });
}

DeviceVolume& Renderer::volume() const
{
    SHVR_CHECK(volume_ != nullptr);
    return *volume_;
}

void Renderer::update_mask(const Mask& mask, std::span<const int64_t> bricks)
{
    mask_.update(mask, bricks);
    if (paged_) paged_->note_painted(mask, bricks);
    const glm::i64vec3 counts = mask.brick_counts();
    if (volume_)
        for (int64_t brick : bricks)
            occlusion_.changed(voxels_of({0, position_of(brick, counts)}, volume_->info().size));
    for (int64_t brick : bricks) {
        const glm::uvec3 first = gpu::BRICK_CELLS * glm::uvec3(position_of(brick, counts));
        empty_space_.changed({first, first + gpu::BRICK_CELLS});
    }
}

const LookTable& Renderer::table_of(const Session& session, double step_voxels)
{
    if (table_ && table_->is_of(session.transfer_function, step_voxels, session.render.preintegration)) return *table_;
    table_ = make_look_table(session.transfer_function, step_voxels, session.render.preintegration);
    table_on_device_.outdate();
    return *table_;
}

/// Of the groups, sent where they look different than before.
Resource Renderer::import_group_looks(FrameGraph& graph, const Session& session, double step_voxels)
{
    std::vector<glm::vec4> looks = make_group_looks(session.groups, step_voxels);
    if (looks != group_looks_) groups_on_device_.outdate();
    group_looks_ = std::move(looks);
    return groups_on_device_.import(graph, group_looks_);
}

LeapGridInput Renderer::want_leap_grid(FrameGraph& graph, const VolumeBinding& volume, const Session& session)
{
    const LookTable& table = table_of(session, session.render.step_voxels);
    LeapGridInput input;
    input.params = {.brick_counts = volume.brick_counts, .skipping = session.render.skip_empty_space};
    set_table(input.params, session.transfer_function, volume_->window(), table.entries());
    input.visible_intervals = table.visible_intervals;
    input.visible_groups = visible_groups(session);
    if (!mask_.empty()) input.mask = mask_.import(graph);
    empty_space_.want(input, volume.cell_counts);
    return input;
}

/// What may be seen does not depend on the length of a step.
Visibility Renderer::visibility_of(const Session& session)
{
    const LookTable& table = table_of(session, table_ ? table_->step_voxels : session.render.step_voxels);
    Visibility visibility{.params = {.skipping = session.render.skip_empty_space},
                          .visible_intervals = table.visible_intervals,
                          .visible_groups = visible_groups(session)};
    set_table(visibility.params, session.transfer_function, volume_->window(), table.entries());
    return visibility;
}

double Renderer::gradient_fade_codes(const Session& session) const
{
    const auto [lower, upper] = statistics_.range();
    return session.light.gradient_fade * ((upper - lower) * volume_->window().codes_per_unit);
}

/// Tells the volume what is looked at. The distance between samples, in reference lengths: samples of coarse bricks may
/// lie farther apart.
double Renderer::look(const Session& session, const Shot& shot, const glm::uvec2& pixels)
{
    if (!paged_) return session.render.step_voxels;
    check_camera(shot.camera);
    paged_->look({.camera = shot.camera,
                  .other_eye = shot.right_eye,
                  .pixels = pixels,
                  .detail = session.render.detail,
                  .cut = shot.is_slice ? CutBox{} : session.cut,
                  .shows_all = shot.is_slice,
                  .shown = always_shown_},
                 visibility_of(session));
    return std::ldexp(session.render.step_voxels, paged_->tree()->finest_level);
}

std::optional<FrameGraph> Renderer::next_preparation(const Session& session)
{
    if (!resident_) return std::nullopt;  // what a view needs depends on the view: `draw` brings it
    FrameGraph graph;
    VolumeBinding volume = resident_->import(graph);
    const LeapGridInput leap = want_leap_grid(graph, volume, session);
    if (!empty_space_.is_due()) return std::nullopt;
    empty_space_.prepare(graph, volume, leap);
    return graph;
}

std::optional<FrameGraph> Renderer::next_refinement(const Session& session)
{
    if (!refinement_is_due()) return std::nullopt;
    FrameGraph graph;
    VolumeBinding volume = resident_->import(graph);
    const LeapGridInput leap = want_leap_grid(graph, volume, session);
    if (!empty_space_.is_worth_refining()) return std::nullopt;
    empty_space_.refine(graph, volume, leap);
    return graph;
}

/// Handles of a volume that is ready to be drawn, and of its paint.
VolumeBinding Renderer::import_prepared(FrameGraph& graph, const Session& session, std::optional<MaskBinding>& mask,
                                        bool feedback)
{
    if (paged_) {
        if (!mask_.empty()) mask = mask_.import(graph);
        return paged_->import(graph, mask_, mask, feedback);
    }
    VolumeBinding volume = resident_->import(graph);
    const LeapGridInput leap = want_leap_grid(graph, volume, session);
    while (empty_space_.is_due()) empty_space_.prepare(graph, volume, leap);
    mask = leap.mask;
    return volume;
}

std::vector<std::string> Renderer::take_messages()
{
    std::vector<std::string> messages = std::exchange(messages_, {});
    if (paged_)
        for (std::string& message : paged_->take_messages()) messages.push_back(std::move(message));
    return messages;
}

void Renderer::show_always(const std::optional<VoxelBox>& voxels)
{
    always_shown_.reset();
    if (!voxels) return;
    const int64_t side = gpu::BRICK_SIZE;
    const Size3 lower = glm::max(voxels->lower, Size3(0)) / side, upper = (voxels->upper + side - int64_t{1}) / side;
    always_shown_ = VoxelBox{lower * side, glm::max(upper, lower) * side};
}

void Renderer::set_keyed_surfaces(std::vector<KeyedSurface> surfaces)
{
    surfaces_.set(SurfaceForest(std::move(surfaces), volume().info()));
}

bool Renderer::replace_surfaces(std::span<const uint64_t> keys, std::span<const KeyedSurface> surfaces)
{
    return surfaces_.replace(keys, surfaces, volume().info());
}

/// Where the rays of a part end at surfaces, among them the probe's ball; nothing where there are none.
std::optional<Resource> Renderer::draw_surfaces(FrameGraph& graph, const Prepared& prepared, const RaycastInput& input,
                                                const Camera& camera, const PicturePart& part)
{
    const bool has_ball = part.probe && part.probe->ball_share > 0.0;
    if (surfaces_.empty() && !has_ball) return std::nullopt;
    const VolumeInfo& info = volume_->info();
    SurfacesInput wanted{.params = input.params,
                         .scene = surfaces_.params(ray_planes(camera, part.pixels, info), part.pixels, info),
                         .listed = prepared.listed,
                         .probe = has_ball,
                         .group_width = input.group_width,
                         .tile = input.tile};
    if (has_ball) {
        const glm::dvec3 origin = glm::dvec3(wanted.scene.origin) + glm::dvec3(wanted.scene.origin_rest);
        wanted.scene.probe_center = part.probe->center / reference_length(info) - origin;
        wanted.scene.probe_radius = float(part.probe->ball_share * part.probe->radius / reference_length(info));
        wanted.scene.probe_color = part.probe->color;
    }
    return surfaces(graph, wanted);
}

Renderer::Prepared Renderer::prepare(FrameGraph& graph, const Session& session, const Shot& shot,
                                     const PicturePart& part, bool feedback)
{
    const glm::uvec2 detail_pixels = part.detail_pixels.x > 0 ? part.detail_pixels : part.pixels;
    const double step_voxels = look(session, shot, detail_pixels);
    const bool is_shaded = session.light.shaded && !shot.is_slice;
    Prepared prepared;
    RaycastInput& input = prepared.input;
    prepared.volume = import_prepared(graph, session, input.mask, feedback);
    if (!shot.is_slice && draws_occlusion(session)) {
        const OcclusionSettings& settings = session.light.occlusion;
        input.occlusion =
            RaycastOcclusion{occlusion_.import(graph).values, {float(settings.strength), float(settings.curve)}};
    }
    input.params = raycast_params(session, shot.camera, *volume_, prepared.volume, part, step_voxels);
    input.params.gradient_fade = float(gradient_fade_codes(session));
    input.table = table_on_device_.import(graph, table_of(session, step_voxels).texels);
    input.shaded = is_shaded;
    input.slice = shot.is_slice;
    input.preintegrated = session.render.preintegration && !shot.is_slice;
    if (shot.is_slice) set_slice(input.params, session, *volume_, statistics_);
    input.group_width = device_.traits().is_cpu ? 16 : 8;
    input.tile = TILE;
    if (part.probe && !shot.is_slice) set_shell(input, *part.probe, *volume_);
    if (!shot.is_slice) {
        prepared.listed = surfaces_.import(graph);
        input.surfaces = draw_surfaces(graph, prepared, input, shot.camera, part);
    }
    if (input.mask) input.groups = import_group_looks(graph, session, step_voxels);
    return prepared;
}

Renderer::Drawn Renderer::draw(FrameGraph& graph, const Session& session, const Shot& shot, const PicturePart& part,
                               Resource target, bool count_work)
{
    Drawn drawn;
    Prepared prepared = prepare(graph, session, shot, part, true);
    prepared.input.count_work = count_work;
    if (!shot.right_eye) {
        drawn.target = cast_rays(graph, prepared.volume, prepared.input, shot.camera, part, target);
    } else {
        const glm::uvec2 size = part.end - part.begin;
        const ResourceDesc desc = image_desc(Format::rgba32_float, glm::uvec3(size, 1));
        RaycastInput right = prepared.input;
        set_rays(right.params, session, *shot.right_eye, volume_->info(), part.pixels);
        right.surfaces = draw_surfaces(graph, prepared, right, *shot.right_eye, part);
        prepared.input.params.target = right.params.target = glm::uvec2(0);
        const Resource seen_left =
            cast_rays(graph, prepared.volume, prepared.input, shot.camera, part, graph.create("left eye", desc));
        const Resource seen_right =
            cast_rays(graph, prepared.volume, right, *shot.right_eye, part, graph.create("right eye", desc));
        drawn.target = anaglyph(graph, seen_left, seen_right, target, size, part.target);
    }
    if (paged_) {
        drawn.reached = graph.read_back(prepared.volume.pages->reached, "what rays came by");
        drawn.tree = paged_->tree();
    }
    return drawn;
}

}  // namespace shvr

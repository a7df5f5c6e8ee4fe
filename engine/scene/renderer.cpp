#include "engine/scene/renderer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <thread>
#include <tuple>
#include <utility>

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
        const ColorGroup look = group_of(session.groups, uint8_t(group));
        if (look.visible && look.opacity > 0.0) bits[group / 32] |= 1u << group % 32;
    }
    return bits;
}

std::vector<gpu::GroupLook> group_looks(const Session& session, double step_voxels)
{
    std::vector<gpu::GroupLook> looks(256);
    for (uint32_t group = 1; group < 256; ++group) {
        const ColorGroup look = group_of(session.groups, uint8_t(group));
        const double opacity = look.visible ? opacity_of_step(look.opacity, step_voxels) : 0.0;
        looks[group] = {glm::vec3(look.color), float(opacity)};
    }
    return looks;
}

double gradient_fade_codes(const Session& session, const DeviceVolume& volume, const VolumeStatistics& statistics)
{
    const ValueRange range = statistics.range();
    return session.light.gradient_fade * ((range.upper - range.lower) * volume.window().codes_per_unit);
}

/// Whether it makes a difference.
bool shows_occlusion(const Light& light)
{
    return light.shaded && light.ambient > 0.0 && light.occlusion.strength > 0.0;
}

/// `step_voxels`: between samples, in reference lengths.
gpu::RaycastParams raycast_params(const Session& session, const Camera& camera, const DeviceVolume& volume,
                                  const VolumeBinding& binding, const VolumeStatistics& statistics,
                                  const PicturePart& part, double step_voxels)
{
    const VolumeInfo& info = volume.info();
    const RayPlanes planes = ray_planes(camera, part.pixels, info);
    const TableMap map = table_map(session.transfer_function, volume.window());
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
    if (binding.pages) {
        params.page_counts = binding.pages->counts;
        params.page_shift = binding.pages->cell_shift;
        params.page_depth = binding.pages->depth;
    }
    params.step = float(step_voxels);
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
    params.gradient_fade = float(gradient_fade_codes(session, volume, statistics));
    if (session.blend.size > 0.0) {
        params.depth_plane = depth_plane(camera, params.box_lower, params.box_upper, info.spacing);
        params.blend_color = session.blend.color.value_or(glm::dvec3(session.render.background));
        params.blend_size = float(session.blend.size);
        params.blend_rate = float(session.blend.rate);
    }
    if (part.probe) {
        params.probe_center = part.probe->center / info.spacing;
        params.probe_radius = float(part.probe->radius / reference_length(info));
        params.probe_color = part.probe->color;
    }
    return params;
}

/// Adds up what the parts of a picture cost, pass by pass.
void append(std::vector<gpu::PassReport>& sum, std::vector<gpu::PassReport> passes)
{
    for (gpu::PassReport& pass : passes) {
        const auto known = std::ranges::find(sum, pass.name, &gpu::PassReport::name);
        if (known == sum.end()) {
            sum.push_back(std::move(pass));
            continue;
        }
        known->gpu_ms += pass.gpu_ms;
        known->dispatches += pass.dispatches;
        for (size_t i = 0; i < known->counters.size(); ++i) known->counters[i] += pass.counters[i];
    }
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
      host_budget_(options.budget.host_bytes > 0 ? options.budget.host_bytes : uint64_t{2} << 30),
      memory_(device_, {options.budget.device_bytes, host_budget_ / 2}),
      executor_(device_, memory_),
      threads_(worker_count(options.threads)),
      mask_(executor_, memory_),
      occlusion_(memory_)
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

bool Renderer::pages(const VolumeSource& source, Paging paging) const
{
    if (paging != Paging::automatic) return paging == Paging::always;
    if (source.levels() > 1) return true;
    // What pictures need beside the volume must find room, too.
    return ResidentVolume::bytes_for(source.info()) > memory_.device_bytes_left() / 16 * 15;
}

void Renderer::load(std::shared_ptr<const VolumeSource> source, const VolumeStatistics& statistics,
                    const RenderSettings& settings)
{
    const IntensityWindow window = window_for(source->info().type, statistics);
    occlusion_.clear();
    occlusion_.set_drawn(nullptr);
    occlusion_has_no_room_ = false;
    volume_.reset();
    resident_ = nullptr;
    paged_ = nullptr;
    leap_state_.reset();
    statistics_ = statistics;
    const bool filtered = filters(settings.sampling);
    const bool comes_and_goes = pages(*source, settings.paging);
    mask_.clear(comes_and_goes);  // paint belongs to the volume it was painted on
    if (!comes_and_goes) {
        auto volume = std::make_unique<ResidentVolume>(executor_, memory_, *source, window, filtered, threads_);
        resident_ = volume.get();
        volume_ = std::move(volume);
        return;
    }
    const PagedVolume::Options options{.filtered = filtered,
                                       .threads = threads_,
                                       .host_bytes = host_budget_ / 4,
                                       .device_bytes = std::min(MOST_ATLAS_BYTES, memory_.device_bytes_left() / 5 * 3)};
    auto volume = std::make_unique<PagedVolume>(executor_, memory_, with_levels(std::move(source), host_budget_),
                                                window, options);
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
    const auto position_of = [&](int64_t brick) {
        return glm::ivec3(brick % counts.x, brick / counts.x % counts.y, brick / (counts.x * counts.y));
    };
    if (volume_)
        for (int64_t brick : bricks) occlusion_.changed(voxels_of({0, position_of(brick)}, volume_->info().size));
    if (bricks.empty() || !leap_state_) return;
    CellBox changed = leap_stage_ == LEAP_STAGES ? CellBox{glm::uvec3(~0u), glm::uvec3(0)} : leap_changed_;
    for (int64_t brick : bricks) {
        const glm::uvec3 first = gpu::BRICK_CELLS * glm::uvec3(position_of(brick));
        changed = {glm::min(changed.begin, first), glm::max(changed.end, first + gpu::BRICK_CELLS)};
    }
    leap_changed_ = changed;
    leap_stage_ = 0;
}

const Renderer::Table& Renderer::table_of(const Session& session, double step_voxels)
{
    const std::span<const ControlPoint> points = session.transfer_function.points();
    if (baked_ && baked_->step_voxels == step_voxels && std::ranges::equal(baked_->points, points)) return *baked_;
    baked_ = {.points = {points.begin(), points.end()},
              .step_voxels = step_voxels,
              .entries = bake_table(session.transfer_function, step_voxels, TABLE_ENTRIES),
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
    const Table& table = table_of(session, session.render.step_voxels);
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

/// What may be seen does not depend on the length of a step.
Visibility Renderer::visibility_of(const Session& session)
{
    const TableMap map = table_map(session.transfer_function, volume_->window());
    const Table& table = table_of(session, baked_ ? baked_->step_voxels : session.render.step_voxels);
    return {.params = {.table_lower = map.lower,
                       .table_upper = map.upper,
                       .table_scale = map.scale,
                       .table_entries = TABLE_ENTRIES,
                       .skipping = session.render.skip_empty_space,
                       .mask_slots = glm::uvec3(0)},
            .visible_intervals = table.visible_intervals,
            .visible_groups = visible_groups(session)};
}

/// Tells the volume what is looked at. The distance between samples, in reference lengths: samples of coarse bricks may
/// lie farther apart.
double Renderer::look(const Session& session, const Camera& camera, const glm::uvec2& pixels)
{
    if (!paged_) return session.render.step_voxels;
    check_camera(camera);
    paged_->look({camera, pixels, session.render.detail, session.cut}, visibility_of(session));
    return std::ldexp(session.render.step_voxels, paged_->tree()->finest_level);
}

std::optional<FrameGraph> Renderer::next_preparation(const Session& session)
{
    if (!resident_) return std::nullopt;  // what a view needs depends on the view: `draw` brings it
    FrameGraph graph;
    VolumeBinding volume = resident_->import(graph);
    const LeapGridInput leap = want_leap_grid(graph, volume, session);
    if (leap_stage_ == LEAP_STAGES) return std::nullopt;
    leap_grid_stage(graph, volume, leap, leap_stage_++);
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
    while (leap_stage_ < LEAP_STAGES) leap_grid_stage(graph, volume, leap, leap_stage_++);
    mask = leap.mask;
    return volume;
}

Occlusion::Look Renderer::occlusion_look(const Session& session)
{
    const OcclusionSettings& settings = session.light.occlusion;
    Occlusion::Look look{.function = session.transfer_function,
                         .visibility = visibility_of(session),
                         .cut = session.cut,
                         .radius = settings.radius,
                         .rays = settings.rays,
                         .full_sphere = settings.full_sphere,
                         .gradient_fade = gradient_fade_codes(session, *volume_, statistics_)};
    for (uint32_t group = 1; group < 256; ++group) {
        const ColorGroup of_group = group_of(session.groups, uint8_t(group));
        look.groups[group] = of_group.visible ? of_group.opacity : 0.0;
    }
    return look;
}

/// Of the bricks that rays came by, those around them, too: light comes from there.
void Renderer::want_around()
{
    if (!paged_ || std::exchange(reached_revision_, paged_->reached_revision()) == paged_->reached_revision()) return;
    std::unordered_set<BrickKey, BrickKeyHash> keys;
    for (const BrickKey& key : paged_->reached_bricks()) {
        const int reach = occlusion_.reach(key.level);
        const glm::ivec3 counts = brick_counts(size_of_level(volume_->info().size, key.level));
        const glm::ivec3 first = glm::max(key.brick - reach, 0), last = glm::min(key.brick + reach, counts - 1);
        for (int z = first.z; z <= last.z; ++z)
            for (int y = first.y; y <= last.y; ++y)
                for (int x = first.x; x <= last.x; ++x) keys.insert({key.level, {x, y, z}});
    }
    paged_->want_around(std::move(keys));
}

/// Whether ambient occlusion is wanted and has room. Where it has none, that is said once, and pictures go without until
/// it is switched off, or another volume comes.
bool Renderer::draws_occlusion(const Session& session)
{
    if (!shows_occlusion(session.light)) {
        occlusion_has_no_room_ = false;
        return false;
    }
    if (occlusion_has_no_room_) return false;
    if (occlusion_.exists_for(*volume_)) return true;
    try {
        occlusion_.look(occlusion_look(session), *volume_, mask_);
    } catch (const Error& error) {
        occlusion_.clear();
        occlusion_has_no_room_ = true;
        messages_.push_back(std::string("ambient occlusion is left out; ") + error.what());
    }
    return !occlusion_has_no_room_;
}

std::vector<std::string> Renderer::take_messages()
{
    std::vector<std::string> messages = std::exchange(messages_, {});
    if (paged_)
        for (std::string& message : paged_->take_messages()) messages.push_back(std::move(message));
    return messages;
}

std::optional<Renderer::OcclusionSlice> Renderer::next_occlusion(const Session& session, const Camera& camera,
                                                                 const Occlusion::Most& most)
{
    if (!draws_occlusion(session)) {
        occlusion_.clear();
        reached_revision_ = 0;
        if (paged_) paged_->want_around({});
        return std::nullopt;
    }
    if (paged_ && !paged_->tree()) return std::nullopt;
    occlusion_.look(occlusion_look(session), *volume_, mask_);
    want_around();
    if (!occlusion_.is_due()) return std::nullopt;
    OcclusionSlice slice;
    std::optional<MaskBinding> mask;
    const VolumeBinding volume = import_prepared(slice.graph, session, mask, false);
    slice.renewed = occlusion_.next(slice.graph, volume, mask, camera.eye / volume_->info().spacing, most);
    return slice;
}

/// All that `session` wants and that can be made with the bricks that are there. Returns the passes.
std::vector<gpu::PassReport> Renderer::make_occlusion(const Session& session, const Camera& camera,
                                                      const RenderOptions& options)
{
    constexpr Occlusion::Most MOST{.bricks = 64, .cell_bricks = 512};
    std::vector<gpu::PassReport> passes;
    if (paged_ && draws_occlusion(session)) {
        occlusion_.look(occlusion_look(session), *volume_, mask_);
        want_around();
        static_cast<void>(paged_->advance(true));
    }
    while (std::optional<OcclusionSlice> slice = next_occlusion(session, camera, MOST))
        append(passes, executor_.run(std::move(slice->graph), {.timestamps = options.timestamps}).passes);
    return passes;
}

Renderer::Prepared Renderer::prepare(FrameGraph& graph, const Session& session, const Camera& camera,
                                     const PicturePart& part, bool feedback)
{
    const glm::uvec2 detail_pixels = part.detail_pixels.x > 0 ? part.detail_pixels : part.pixels;
    const double step_voxels = look(session, camera, detail_pixels);
    Prepared prepared;
    RaycastInput& input = prepared.input;
    prepared.volume = import_prepared(graph, session, input.mask, feedback);
    if (draws_occlusion(session)) {
        const OcclusionSettings& settings = session.light.occlusion;
        input.occlusion =
            RaycastOcclusion{occlusion_.import(graph).values, {float(settings.strength), float(settings.curve)}};
    }
    input.params = raycast_params(session, camera, *volume_, prepared.volume, statistics_, part, step_voxels);
    input.table = upload_table(graph, table_of(session, step_voxels));
    input.shaded = session.light.shaded;
    input.group_width = device_.traits().is_cpu ? 16 : 8;
    input.tile = TILE;
    input.probe = part.probe.has_value();
    if (input.mask) {
        input.params.mask_slots = input.mask->slots;
        input.groups = group_looks(session, step_voxels);
    }
    return prepared;
}

Renderer::Drawn Renderer::draw(FrameGraph& graph, const Session& session, const Camera& camera, const PicturePart& part,
                               Resource target, bool count_work)
{
    Prepared prepared = prepare(graph, session, camera, part, true);
    prepared.input.count_work = count_work;
    Drawn drawn;
    drawn.target = raycast(graph, prepared.volume, prepared.input, target);
    if (paged_) {
        drawn.reached = graph.read_back(prepared.volume.pages->reached, "what rays came by");
        drawn.tree = paged_->tree();
    }
    return drawn;
}

/// One part of a picture, with the bricks that are there. Its pixels go to `picture`; the read-back to the volume.
void Renderer::render_part(Picture& picture, const Session& session, const Camera& camera, const PicturePart& part,
                           const RenderOptions& options)
{
    picture.graph = FrameGraph();
    const glm::uvec2 size = part.end - part.begin;
    const Resource color = picture.graph.create("color", image_desc(Format::rgba32_float, glm::uvec3(size, 1)));
    const Drawn drawn = draw(picture.graph, session, camera, part, color, options.count_work);
    const uint32_t pixels = picture.graph.read_back(drawn.target);
    gpu::FrameResult result =
        executor_.run(picture.graph, {.timestamps = options.timestamps, .serialize = options.serialize});
    if (drawn.reached) paged_->note_reached(drawn.tree, result.read_backs[*drawn.reached]);
    const std::byte* row = result.read_backs[pixels].data();
    const size_t row_bytes = size_t(size.x) * 4 * sizeof(float);
    for (uint32_t y = 0; y < size.y; ++y, row += row_bytes)
        std::memcpy(&picture.image.rgba[4 * (part.begin.x + size_t(part.pixels.x) * (part.begin.y + y))], row,
                    row_bytes);
    picture.wall_ms += result.wall_ms;
    picture.passes = std::move(result.passes);
}

Picture Renderer::render(const Session& session, const Camera& camera, const RenderOptions& options)
{
    Picture picture;
    const glm::uvec2 size = session.render.size;
    picture.image = {int(size.x), int(size.y), {}};
    picture.image.rgba.resize(size_t(size.x) * size.y * 4);
    const PicturePart whole{.pixels = size, .end = size, .probe = options.probe};
    if (!paged_) {
        std::vector<gpu::PassReport> passes = make_occlusion(session, camera, options);
        render_part(picture, session, camera, whole, options);
        append(picture.passes, std::move(passes));
        picture.complete = !occlusion_has_no_room_;
        picture.warnings = take_messages();
        return picture;
    }
    // Draw, load what rays came by, and draw again, until they come by nothing that is not there. What needs more bricks
    // at once than there is room for is drawn in quarters.
    std::vector<gpu::PassReport> passes;
    std::vector<PicturePart> parts{whole};
    while (!parts.empty()) {
        const PicturePart part = parts.back();
        parts.pop_back();
        look(session, camera, size);
        if (parts.size() > 0 || part.end - part.begin != size) paged_->forget_reached();
        for (;;) {
            append(passes, make_occlusion(session, camera, options));
            render_part(picture, session, camera, part, options);
            static_cast<void>(paged_->advance(true));
            if (occlusion_.is_due()) continue;  // on what rays came by for the first time
            if (paged_->state() == PagedVolume::State::complete && !paged_->is_stale()) break;
            if (paged_->state() == PagedVolume::State::limited) break;
        }
        const glm::uvec2 extent = part.end - part.begin;
        if (paged_->state() == PagedVolume::State::limited && extent.x * extent.y > 1) {
            const glm::uvec2 middle = part.begin + (extent + 1u) / 2u;
            for (const bool below : {true, false})
                for (const bool right : {true, false}) {
                    PicturePart quarter = part;
                    (right ? quarter.begin.x : quarter.end.x) = middle.x;
                    (below ? quarter.begin.y : quarter.end.y) = middle.y;
                    if (quarter.begin.x < quarter.end.x && quarter.begin.y < quarter.end.y) parts.push_back(quarter);
                }
            continue;
        }
        picture.complete =
            picture.complete && paged_->state() == PagedVolume::State::complete && paged_->missing() == 0;
        append(passes, std::move(picture.passes));
    }
    picture.passes = std::move(passes);
    picture.complete = picture.complete && !occlusion_has_no_room_;
    picture.warnings = take_messages();
    return picture;
}

std::optional<glm::dvec3> Renderer::pick(const Session& session, const Camera& camera, const glm::uvec2& pixels,
                                         const glm::uvec2& pixel)
{
    FrameGraph graph;
    Prepared prepared = prepare(graph, session, camera, {.pixels = pixels, .begin = pixel, .end = pixel + 1u}, false);
    prepared.input.pick = true;
    prepared.input.shaded = false;
    prepared.input.params.opacity_limit = std::min(prepared.input.params.opacity_limit, 0.5f);
    const Resource reached = graph.create("reached voxel", image_desc(Format::rgba32_float, glm::uvec3(1)));
    const uint32_t index = graph.read_back(raycast(graph, prepared.volume, prepared.input, reached));
    const gpu::FrameResult result = executor_.run(std::move(graph), {.timestamps = false});
    glm::vec4 voxel_and_hit;
    std::memcpy(&voxel_and_hit, result.read_backs[index].data(), sizeof voxel_and_hit);
    if (voxel_and_hit.w == 0.0f) return std::nullopt;
    return glm::dvec3(voxel_and_hit) * volume_->info().spacing;
}

}  // namespace shvr

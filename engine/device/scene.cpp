#include "engine/device/scene.h"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/device/paged_volume.h"
#include "engine/device/resident_volume.h"
#include "engine/device/trace_surfaces.h"
#include "engine/volume/grid.h"
#include "engine/volume/levels/pyramid_source.h"

namespace shvr {

namespace {

// The following constants divide the device memory that is free when a volume is loaded.
/// A resident volume leaves this many sixteenths of that free memory for tables and pictures drawn in parts.
constexpr uint64_t PICTURE_SIXTEENTHS = 1;
/// Minimum reserved for pictures and tables: one or two megabytes for tables, the directory of bricks, and pictures
/// drawn in parts of 64 x 64 pixels.
constexpr uint64_t MIN_PICTURE_BYTES = uint64_t{4} << 20;
/// Fifths of that free memory for paged bricks; the rest is for pictures, mask and surfaces, which may grow.
constexpr uint64_t PAGED_FIFTHS = 3;
/// Fifths for paged bricks if there is ambient occlusion, which takes 0.7 times as much memory as bricks of 16 bits and
/// 1.3 times as much as those of 8 bits.
constexpr uint64_t PAGED_FIFTHS_WITH_OCCLUSION = 2;
/// Limit of the atlas on a CPU device, whose memory is shared with files and programs. 27 000 bricks fit, more than a
/// view needs on a common screen.
constexpr uint64_t MAX_ATLAS_BYTES_OF_CPU = uint64_t{2} << 30;
/// Number of shares of the host's budget: one is for paged bricks, one for coarser levels, and two for mapped memory.
constexpr uint64_t HOST_SHARES = 4;
/// A view of up to this many bricks can show the finest level everywhere: the maximum number of leaves (page_tree.h).
constexpr int64_t MAX_FINEST_BRICKS = int64_t{1} << 17;

/// Distance in voxels up to which an offset affects the picture through interpolation and gradients.
constexpr int64_t RAISED_REACH = 2;
/// Maximum number of boxes stored until take_changed() is called. Further boxes are merged into one per cause.
constexpr size_t MAX_CHANGED = 4096;

bool filters(const gpu::DeviceTraits& traits, Sampling sampling)
{
    if (sampling == Sampling::hardware && !traits.linear_r16)
        fail("render.sampling is hardware, but device ", traits.name,
             " cannot filter R16_UNORM; expected automatic or exact");
    // On a CPU, filtering costs more than loading and computing; on a GPU, the sampler is nearly free.
    return sampling == Sampling::hardware || (sampling == Sampling::automatic && !traits.is_cpu && traits.linear_r16);
}

AtlasCodes codes_of(const gpu::Memory& memory, const VolumeSource& source, const Scene::Options& options)
{
    return Scene::codes_for(memory.traits(), source.info().type, options.sampling);
}

uint64_t bytes_for_pictures(uint64_t bytes_left)
{
    return std::max(MIN_PICTURE_BYTES, bytes_left / 16 * PICTURE_SIXTEENTHS);
}

uint64_t bytes_for_pictures(const gpu::Memory& memory)
{
    return bytes_for_pictures(memory.device_bytes_left());
}

/// Device memory for ambient occlusion, in addition to the part per brick.
uint64_t scratch_bytes(const gpu::Memory& memory, const Scene::Options& options)
{
    return options.with_occlusion ? Occlusion::scratch_bytes(memory.traits(), memory.device_budget()) : 0;
}

/// Device memory for the bricks' ambient light, plus a quarter because layouts round up and devices align rows.
uint64_t light_bytes(uint64_t bricks)
{
    return bricks * (Occlusion::slot_bytes() / 4 * 5);
}

/// `left`: the free device memory.
bool fits_resident(const gpu::Memory& memory, uint64_t left, const VolumeSource& source, const Scene::Options& options,
                   uint64_t reserved_bytes)
{
    const uint64_t bytes =
        Scene::resident_bytes(source.info(), codes_of(memory, source, options), options.with_occlusion);
    const uint64_t beside = bytes_for_pictures(left) + reserved_bytes + scratch_bytes(memory, options);
    return beside <= left && bytes <= left - beside;
}

bool fits_resident(const gpu::Memory& memory, const VolumeSource& source, const Scene::Options& options,
                   uint64_t reserved_bytes)
{
    return fits_resident(memory, memory.device_bytes_left(), source, options, reserved_bytes);
}

bool pages(const gpu::Memory& memory, const VolumeSource& source, const Scene::Options& options,
           uint64_t reserved_bytes = 0)
{
    if (options.paging != Paging::automatic) return options.paging == Paging::always;
    return source.levels() > 1 || !fits_resident(memory, source, options, reserved_bytes) ||
           !Scene::can_be_resident(memory, source, options);
}

int64_t finest_bricks(const VolumeInfo& info)
{
    const glm::i64vec3 counts(brick_counts(info.size));
    return counts.x * counts.y * counts.z;
}

/// The budget, in MiB, that leaves `bytes` free in addition to the share for pictures.
uint64_t budget_for(uint64_t bytes)
{
    return (std::max(bytes + MIN_PICTURE_BYTES, bytes / (16 - PICTURE_SIXTEENTHS) * 16) >> 20) + 1;
}

/// Device memory for the atlas of paged bricks.
uint64_t atlas_bytes(const gpu::Memory& memory, const VolumeInfo& info, AtlasCodes codes, bool with_occlusion,
                     uint64_t reserved_bytes)
{
    const uint64_t budget = memory.device_budget(), left = memory.device_bytes_left();
    const uint64_t of_slot = BrickAtlas::slot_bytes(codes);
    const uint64_t with_light = of_slot + (with_occlusion ? light_bytes(1) : 0);
    const auto scratch = [&](uint64_t of_budget) {
        return with_occlusion ? Occlusion::scratch_bytes(memory.traits(), of_budget) : 0;
    };
    const uint64_t beside = bytes_for_pictures(memory) + reserved_bytes + scratch(budget);
    const uint64_t room = left - std::min(left, beside);
    // Layouts of images round up.
    const uint64_t fewest = std::min(PagedVolume::MIN_SLOTS + 8, uint64_t(2 * finest_bricks(info) + 1)) * with_light;
    const uint64_t rest = budget - left + reserved_bytes + fewest;  // over half of the budget that the message states
    if (room < fewest)
        throw gpu::BudgetError(
            sentence(info.name, ": a picture needs ", gpu::mebibytes(beside + fewest), " of device memory",
                     reserved_bytes > 0 ? sentence(", ", gpu::mebibytes(reserved_bytes), " of them for paint and trace")
                                        : std::string(),
                     ", and ", gpu::mebibytes(left), " of the budget of ", gpu::mebibytes(budget),
                     " are left; expected at least --budget-device ", budget_for(rest + scratch(2 * rest))));
    const uint64_t fifths = with_occlusion ? PAGED_FIFTHS_WITH_OCCLUSION : PAGED_FIFTHS;
    return std::min({Scene::most_atlas_bytes(memory.traits(), codes, with_occlusion),
                     std::max(left / 5 * fifths, fewest / with_light * of_slot), room / with_light * of_slot});
}

/// Upper bound of the device memory for a trace.
uint64_t trace_bytes(const TraceGraph& trace)
{
    const size_t surfaces = trace.nodes().size() + trace.internodes().size();
    if (surfaces == 0) return 0;
    return (surfaces + SurfaceForest::MAX_SURFACES_ADDED) * (sizeof(gpu::Surface) + 2 * sizeof(gpu::SurfaceNode));
}

}  // namespace

Scene::Scene(gpu::Executor& executor, gpu::Memory& memory, std::shared_ptr<const VolumeSource> source,
             const VolumeStatistics& statistics, const Options& options)
    : executor_(executor),
      memory_(memory),
      source_(std::move(source)),
      options_(options),
      statistics_(statistics),
      draws_finest_(options.paging == Paging::automatic && source_->levels() == 1 &&
                    finest_bricks(source_->info()) <= MAX_FINEST_BRICKS),
      occlusion_(memory),
      surfaces_(memory),
      meshes_(memory),
      tables_(memory)
{
    load(options_.reserved_bytes);
    options_.in_slices = false;  // make_room() chooses for itself
}

uint64_t Scene::next_number()
{
    static uint64_t last = 0;  // of the thread that owns the device
    return ++last;
}

/// `reserved_bytes`: device memory for paint, offsets and surfaces. `host_bricks`: those of offsets_; null: none.
void Scene::load(uint64_t reserved_bytes, const std::shared_ptr<BrickStore>& host_bricks)
{
    memory_.free_idle();
    const IntensityWindow window = window_for(source_->info().type, statistics_);
    const AtlasCodes codes = codes_of(memory_, *source_, options_);
    const bool is_paged = pages(memory_, *source_, options_, reserved_bytes) || !load_resident(window);
    mask_.emplace(executor_, memory_, is_paged);
    if (is_paged) load_paged(window, codes, reserved_bytes, host_bricks);
    if (!has_exact_codes(source_->info().type, statistics_))
        threshold_bricks_ = std::make_unique<ThresholdBricks>(offsets_);
}

void Scene::load_paged(const IntensityWindow& window, AtlasCodes codes, uint64_t reserved_bytes,
                       std::shared_ptr<BrickStore> host_bricks)
{
    const bool goes_on = host_bricks != nullptr;
    PagedVolume::Options paged{
        .codes = codes,
        .threads = options_.threads,
        .host_bytes = options_.host_bytes / HOST_SHARES,
        .device_bytes = atlas_bytes(memory_, source_->info(), codes, options_.with_occlusion, reserved_bytes),
        .in_slices = options_.in_slices || (goes_on && reads_in_background_),
        .host_bricks = std::move(host_bricks)};
    if (!goes_on) {
        source_ = with_levels(std::move(source_), options_.host_bytes, options_.progress);
        held_ = std::make_shared<HeldSource>(source_);
        offsets_ = std::make_shared<OffsetSource>(held_);
    }
    while (!volume_) {
        try {
            volume_ = std::make_unique<PagedVolume>(executor_, memory_, offsets_, window, paged);
        } catch (const gpu::BudgetError&) {
            throw;
        } catch (const gpu::MemoryError&) {  // the driver has less memory than it reports, or not in one block
            constexpr uint64_t LEAST = uint64_t{16} << 20;
            if (paged.device_bytes / 2 < LEAST) throw;
            paged.device_bytes /= 2;
            memory_.free_idle();
        }
    }
    if (goes_on) volume_->load_on(0.0);  // what the host has
}

/// Returns false if memory is too short (drivers overstate it, other programs use some) but bricks can be paged.
bool Scene::load_resident(const IntensityWindow& window)
{
    const AtlasCodes codes = codes_of(memory_, *source_, options_);
    held_ = std::make_shared<HeldSource>(source_);
    offsets_ = std::make_shared<OffsetSource>(held_);
    try {
        if (options_.in_slices)
            volume_ = std::make_unique<ResidentVolume>(executor_, memory_, offsets_, window, codes, options_.threads,
                                                       ResidentVolume::InSlices{});
        else
            volume_ = std::make_unique<ResidentVolume>(executor_, memory_, offsets_, window, codes, options_.threads,
                                                       options_.progress);
        return true;
    } catch (const gpu::MemoryError&) {
        if (options_.paging == Paging::never) throw;
        return false;
    }
}

/// Whether `bytes` are free on the device, in addition to the pictures' share.
bool Scene::has_room(uint64_t bytes)
{
    memory_.free_idle();
    const glm::u64vec3 slots(volume_->atlas_slots());
    const uint64_t light = options_.with_occlusion ? light_bytes(slots.x * slots.y * slots.z) : 0;
    return bytes + bytes_for_pictures(memory_) + light + scratch_bytes(memory_, options_) <=
           memory_.device_bytes_left();
}

/// Whether the volume may be loaded with fewer bricks. One that has no levels and is resident would be read as a whole
/// to make them.
bool Scene::can_shrink() const
{
    const bool is_paged = volume_->host_bricks() != nullptr;
    return is_paged || (options_.paging != Paging::never && !(reads_in_background_ && source_->levels() == 1));
}

/// Keeps `bytes` free on the device, in addition to the pictures' share, by loading the volume with fewer bricks. Where
/// that is impossible, the volume stays as it is: what is shown next fails if it does not fit.
void Scene::make_room(uint64_t bytes)
{
    if (has_room(bytes) || !can_shrink()) return;
    const std::shared_ptr<const OffsetSource> read_from = offsets_;  // outlives the bricks that loaders read from it
    const std::shared_ptr<BrickStore> host_bricks = offsets_->empty() ? volume_->host_bricks() : nullptr;
    occlusion_.clear();
    volume_.reset();
    mask_.reset();
    try {
        load(bytes, host_bricks);
    } catch (const gpu::MemoryError&) {
        load(0, host_bricks);  // the volume stays loaded, without the features that do not fit
        throw;
    }
}

uint64_t Scene::bytes_to_show(const Document& document)
{
    const size_t painted = document.mask.painted_bricks().size();
    return (painted == 0 ? 0 : DeviceMask::bytes_for(painted)) + trace_bytes(document.trace);
}

uint64_t Scene::atlas_share(uint64_t device_budget, bool with_occlusion)
{
    return device_budget / 5 * (with_occlusion ? PAGED_FIFTHS_WITH_OCCLUSION : PAGED_FIFTHS);
}

uint64_t Scene::resident_bytes(const VolumeInfo& info, AtlasCodes codes, bool with_occlusion)
{
    return ResidentVolume::bytes_for(info, codes) + (with_occlusion ? light_bytes(uint64_t(finest_bricks(info))) : 0);
}

AtlasCodes Scene::codes_for(const gpu::DeviceTraits& traits, VoxelType type, Sampling sampling)
{
    if (filters(traits, sampling)) return AtlasCodes::filtered;
    // For these types the window always covers the type's whole range, regardless of the values (window_for).
    return type == VoxelType::uint8 || type == VoxelType::int8 ? AtlasCodes::exact8 : AtlasCodes::exact16;
}

/// The atlas may use several images, but with ambient light only one: an image of half the size must hold the light.
uint64_t Scene::most_atlas_bytes(const gpu::DeviceTraits& traits, AtlasCodes codes, bool with_occlusion)
{
    const uint64_t of_image = std::min(traits.max_volume_bytes / slot_code_bytes(codes),
                                       max_atlas_slots(gpu::BRICK_TEXELS, traits.limits.maxImageDimension3D));
    const uint64_t slots = of_image * (with_occlusion ? 1 : gpu::MAX_ATLASES);
    return std::min(traits.is_cpu ? MAX_ATLAS_BYTES_OF_CPU : UINT64_MAX, slots * BrickAtlas::slot_bytes(codes));
}

/// Some devices limit images to 256 texels a side, or allocations to 2 GiB.
bool Scene::can_be_resident(const gpu::Memory& memory, const VolumeSource& source, const Options& options)
{
    return ResidentVolume::is_possible(memory, source.info(), codes_of(memory, source, options));
}

bool Scene::pages_alone(const gpu::Memory& memory, const VolumeSource& source, const Options& options)
{
    if (options.paging != Paging::automatic) return options.paging == Paging::always;
    return source.levels() > 1 ||
           !fits_resident(memory, memory.device_budget(), source, options, options.reserved_bytes) ||
           !can_be_resident(memory, source, options);
}

bool Scene::fits_now(gpu::Memory& memory, const VolumeSource& source, const Options& options)
{
    static_cast<void>(codes_of(memory, source, options));
    return !pages(memory, source, options, options.reserved_bytes) &&
           fits_resident(memory, source, options, options.reserved_bytes);
}

void Scene::check_sizes(gpu::Memory& memory, const VolumeSource& source, const Options& options)
{
    const AtlasCodes codes = codes_of(memory, source, options);
    const uint64_t left = memory.device_bytes_left(), bytes = ResidentVolume::bytes_for(source.info(), codes);
    if (pages(memory, source, options)) {
        const uint64_t atlas = atlas_bytes(memory, source.info(), codes, options.with_occlusion, 0);
        const int levels = planned_levels(source, options.host_bytes);
        PagedVolume::check_room(memory.traits(), source.info(), levels, codes, atlas);
    } else if (!can_be_resident(memory, source, options)) {
        fail(source.info().name, ": render.paging is never, and an image of device ", memory.traits().name,
             " cannot hold all of its bricks; expected render.paging automatic");
    } else if (bytes > left) {
        throw gpu::BudgetError(sentence(source.info().name, ": render.paging is never, and its bricks need ",
                                        gpu::mebibytes(bytes), " of device memory, of which ", gpu::mebibytes(left),
                                        " are left; expected render.paging automatic, or at least --budget-device ",
                                        budget_for(memory.device_budget() - left + bytes)));
    }
}

// ---- Changes --------------------------------------------------------------------------------------------------------

void Scene::show(const Document& document)
{
    const std::vector<int64_t> painted = document.mask.painted_bricks();
    const uint64_t bytes = bytes_to_show(document);
    if (bytes > 0) make_room(bytes);
    if (!painted.empty()) update_mask(document.mask, painted);
    std::vector<VoxelBox> raised;
    for (const int64_t brick : document.density.painted_bricks()) raised.push_back(document.density.box_of(brick));
    if (!raised.empty()) update_density(document.density, raised);
}

bool Scene::show(const Document& document, std::span<const Change> changes)
{
    const Touched touched = touched_by(document, changes);
    show_trace(document.trace, changes);
    show(document, touched);
    return !touched.mask_bricks.empty() || !touched.raised.empty();
}

void Scene::show(const Document& document, const Touched& touched, const std::optional<VoxelBox>& within)
{
    // Steps that can fail come last, so that a failure loses no change.
    if (!touched.raised.empty()) note_density(document.density, touched.raised);
    if (!touched.mask_bricks.empty()) update_mask(document.mask, touched.mask_bricks, within);
    renew_density();
}

void Scene::catch_up(const Document& document)
{
    if (mask_->is_stale()) update_mask(document.mask, {});
    renew_density();
}

void Scene::update_mask(const Mask& mask, std::span<const int64_t> bricks, const std::optional<VoxelBox>& within)
{
    note_mask(mask, bricks, within);
    if (mask_->is_stale()) note_mask(mask, mask.painted_bricks());  // the device holds none of the mask
    mask_->update(mask, bricks);
}

void Scene::note_mask(const Mask& mask, std::span<const int64_t> bricks, const std::optional<VoxelBox>& within)
{
    volume_->note_painted(mask, bricks);
    for (const int64_t brick : bricks) {
        VoxelBox voxels = voxels_of({0, position_of(brick, mask.brick_counts())}, info().size);
        occlusion_.changed(voxels);
        if (within) voxels = {glm::max(voxels.lower, within->lower), glm::min(voxels.upper, within->upper)};
        if (glm::any(glm::greaterThanEqual(voxels.lower, voxels.upper))) continue;
        voxels = grown(voxels, 1);  // smooth borders end between voxels
        note_changed({glm::max(voxels.lower, Size3(0)), glm::min(voxels.upper, info().size)}, Cause::edit);
    }
}

void Scene::update_density(const DensityField& field, std::span<const VoxelBox> changed)
{
    note_density(field, changed);
    renew_density();
}

void Scene::note_density(const DensityField& field, std::span<const VoxelBox> changed)
{
    SHVR_CHECK(field.size() == info().size && field.type() == info().type, "the offsets are of another volume");
    std::vector<int64_t> bricks;
    for (const VoxelBox& box : changed) {
        const RegionBricks around = bricks_around(box);
        for (uint32_t z = 0; z < around.counts.z; ++z)
            for (uint32_t y = 0; y < around.counts.y; ++y)
                for (uint32_t x = 0; x < around.counts.x; ++x)
                    bricks.push_back(
                        index_of(glm::i64vec3(around.begin + glm::uvec3(x, y, z)), glm::i64vec3(field.brick_counts())));
    }
    std::ranges::sort(bricks);
    bricks.erase(std::ranges::unique(bricks).begin(), bricks.end());
    std::vector<OffsetSource::Brick> offsets;
    for (const int64_t brick : bricks) offsets.push_back({field.position_of(brick), field.brick(brick)});
    offsets_->set(offsets);
    if (threshold_bricks_) threshold_bricks_->renew(changed);
    unshown_density_.insert(unshown_density_.end(), changed.begin(), changed.end());
}

/// Whether the voxels that renew() reads are in memory, or may be waited for.
bool Scene::voxels_are_there()
{
    if (!reads_in_background_) return true;
    std::vector<HeldSource::Part> parts;
    for (const BrickKey& key : volume_->read_to_renew(unshown_density_))
        parts.push_back({key.level, voxels_of_texels(key, info().size)});
    return held_->hold(parts);
}

void Scene::renew_density()
{
    if (unshown_density_.empty()) return;
    awaits_voxels_ = !voxels_are_there();
    if (awaits_voxels_) return;
    try {
        volume_->renew(unshown_density_);
    } catch (...) {
        held_->release();
        throw;
    }
    held_->release();
    for (const VoxelBox& box : std::exchange(unshown_density_, {})) {
        occlusion_.changed(box, gpu::BRICK_APRON);
        note_changed({glm::max(box.lower - RAISED_REACH, Size3(0)), glm::min(box.upper + RAISED_REACH, info().size)},
                     Cause::edit);
    }
}

void Scene::show_surfaces(std::vector<SurfaceLook> surfaces, const TraceGraph& trace, const Groups& groups)
{
    std::vector<KeyedSurface> all = surfaces_of(trace, groups, info().spacing);
    const std::vector<KeyedSurface> of_session = keyed(surfaces);
    all.insert(all.begin(), of_session.begin(), of_session.end());
    if (!surfaces_.restyle(all, info())) surfaces_.set(SurfaceForest(std::move(all), info()));
    trace_look_ = TraceLook{std::move(surfaces), groups};
}

void Scene::show_trace(const TraceGraph& trace, std::span<const Change> changes)
{
    const bool is_traced =
        std::ranges::any_of(changes, [](const Change& change) { return std::holds_alternative<TraceChange>(change); });
    if (!is_traced || !trace_look_) return;
    const std::optional<ChangedSurfaces> changed =
        changed_surfaces(trace, trace_look_->groups, info().spacing, changes);
    if (!changed || !replace_surfaces(changed->keys, changed->now))
        show_surfaces(trace_look_->surfaces, trace, Groups(trace_look_->groups));
    note_changed(trace_reach(trace, changes, info().spacing), Cause::edit);
}

void Scene::set_keyed_surfaces(std::vector<KeyedSurface> surfaces)
{
    surfaces_.set(SurfaceForest(std::move(surfaces), info()));
    trace_look_.reset();
}

bool Scene::replace_surfaces(std::span<const uint64_t> keys, std::span<const KeyedSurface> surfaces)
{
    return surfaces_.replace(keys, surfaces, info());
}

void Scene::advance(bool wait, const Progress& progress)
{
    for (const VoxelBox& voxels : volume_->advance(wait, progress)) note_changed(voxels, Cause::bricks);
}

void Scene::note_changed(const VoxelBox& voxels, Cause cause)
{
    if (glm::any(glm::greaterThanEqual(voxels.lower, voxels.upper))) return;
    changed_.push_back({voxels, cause});
    if (changed_.size() < MAX_CHANGED) return;
    std::array<std::optional<VoxelBox>, 3> all;
    for (const Changed& changed : std::exchange(changed_, {})) {
        std::optional<VoxelBox>& of_cause = all[size_t(changed.cause)];
        of_cause = of_cause ? united(*of_cause, changed.voxels) : changed.voxels;
    }
    for (size_t of = 0; of < all.size(); ++of)
        if (all[of]) changed_.push_back({*all[of], Cause(of)});
}

std::vector<Scene::Changed> Scene::take_changed()
{
    return std::exchange(changed_, {});
}

// ---- Look -----------------------------------------------------------------------------------------------------------

Visibility Scene::visibility_of(const Look& look)
{
    Visibility visibility = tables_.visibility_of(look, volume_->window());
    visibility.params.guard = filters(traits(), options_.sampling) ? gpu::GUARD_FILTERED : gpu::GUARD_EXACT;
    return visibility;
}

double Scene::gradient_fade_codes(const Light& light) const
{
    const auto [lower, upper] = statistics_.range();
    return light.gradient_fade * ((upper - lower) * volume_->window().codes_per_unit);
}

Occlusion::Look Scene::occlusion_look(const Look& look)
{
    const OcclusionSettings& settings = look.light.occlusion;
    Occlusion::Look wanted{.function = look.transfer_function,
                           .visibility = visibility_of(look),
                           .cut = look.cut,
                           .radius = settings.radius,
                           .rays = settings.rays,
                           .full_sphere = settings.full_sphere,
                           .gradient_fade = gradient_fade_codes(look.light),
                           .preintegrated = look.render.classifies_steps()};
    for (uint32_t group = 1; group < 256; ++group) {
        const ColorGroup of_group = group_of(look.groups, uint8_t(group));
        wanted.groups[group] = of_group.visible ? of_group.opacity : 0.0;
    }
    return wanted;
}

bool Scene::has_occlusion(const Look& look)
{
    if (!shows_occlusion(look.light)) {
        occlusion_has_no_room_ = false;
        return false;
    }
    if (occlusion_has_no_room_) return false;
    if (occlusion_.exists_for(*volume_)) return true;
    try {
        occlusion_.look(occlusion_look(look), *volume_, *mask_);
    } catch (const gpu::DeviceLost&) {
        throw;
    } catch (const Error& error) {
        drop_occlusion(error.what());
    }
    return !occlusion_has_no_room_;
}

void Scene::drop_occlusion(const std::string& why)
{
    occlusion_.clear();
    occlusion_has_no_room_ = true;
    messages_.push_back("ambient occlusion is not drawn: " + why);
}

bool Scene::give_way(const std::string& why)
{
    if (!occlusion_.has_memory()) return false;
    volume_->want_around({});
    drop_occlusion(why);
    return true;
}

void Scene::want_occlusion(const Look& look)
{
    const Occlusion::Look wanted = occlusion_look(look);
    occlusion_.look(wanted, *volume_, *mask_);
    volume_->want_around(occlusion_.reach());
    volume_->look_by(wanted.visibility);
}

void Scene::add_occlusion(FrameGraph& graph, const Camera& camera, const Occlusion::Most& most)
{
    const std::optional<MaskBinding> mask = mask_->import(graph);
    const VolumeBinding volume = volume_->prepare(graph, *mask_, mask, false);
    for (const VoxelBox& voxels : occlusion_.next(graph, volume, mask, camera.eye / info().spacing, most))
        note_changed(voxels, Cause::light);
}

std::vector<std::string> Scene::take_messages()
{
    std::vector<std::string> messages = std::exchange(messages_, {});
    for (std::string& message : volume_->take_messages()) messages.push_back(std::move(message));
    return messages;
}

}  // namespace shvr

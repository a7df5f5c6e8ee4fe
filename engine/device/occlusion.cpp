#include "engine/device/occlusion.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "engine/device/look_table.h"
#include "engine/look/split_digits.h"
#include "engine/passes/occlusion_stretch.h"
#include "engine/volume/grid.h"

namespace shvr {

static_assert(MAX_OCCLUSION_RADIUS == OCCLUSION_MAX_RADIUS);

namespace {

/// Light comes from up to this much beyond the radius: rays start off the surface, plus half a cell and the voxel.
constexpr double MARGIN_VOXELS = 8.0;

/// Scratch memory for `bricks` paged bricks; resident bricks need less.
uint64_t slice_bytes(uint32_t bricks)
{
    uint64_t bytes = occlusion_near_desc(bricks, true).bytes;
    for (uint32_t size = 0; size < gpu::OCCLUSION_SIZES; ++size) bytes += occlusion_around_desc(size, bricks).bytes;
    return bytes;
}

/// Number of bricks to update at once, such that their scratch memory is at most a sixteenth of the budget. On a CPU, a
/// few bricks keep all cores busy and stay in the caches.
uint32_t slice_for(const gpu::DeviceTraits& traits, uint64_t device_budget)
{
    const uint64_t most = traits.is_cpu ? gpu::OCCLUSION_COLUMN : gpu::OCCLUSION_SLICE;
    const uint32_t column = traits.limits.maxImageDimension3D / occlusion_near_desc(1, true).texels.z;
    const uint64_t room = column < gpu::OCCLUSION_COLUMN ? std::max(column, 1u) : most;
    return uint32_t(std::clamp<uint64_t>(device_budget / 16 / slice_bytes(1), 1, std::min(room, most)));
}

template <class Visit>
void for_each_offset(int reach, const Visit& visit)
{
    for (int z = -reach; z <= reach; ++z)
        for (int y = -reach; y <= reach; ++y)
            for (int x = -reach; x <= reach; ++x) visit(glm::ivec3(x, y, z));
}

bool same_function(const Occlusion::Look& a, const Occlusion::Look& b)
{
    Visibility without_groups = a.visibility;
    without_groups.visible_groups = b.visibility.visible_groups;
    return without_groups == b.visibility && std::ranges::equal(a.function.points(), b.function.points());
}

}  // namespace

void Occlusion::clear()
{
    values_.reset();
    near_.reset();
    for (gpu::Storage& cells : cells_) cells.reset();
    for (gpu::Storage& around : around_) around.reset();
    entries_.clear();
    look_.reset();
    volume_ = nullptr;
    revision_ = 0;
}

uint64_t Occlusion::slot_bytes()
{
    constexpr uint64_t TEXELS = gpu::BRICK_TEXELS;
    uint64_t bytes = TEXELS * TEXELS * TEXELS;
    for (uint32_t size = 0; size < gpu::OCCLUSION_SIZES; ++size) {
        const uint64_t side = gpu::BRICK_SIZE >> (size + 1);
        bytes += sizeof(uint32_t) * side * side * side;
    }
    return bytes;
}

uint64_t Occlusion::scratch_bytes(const gpu::DeviceTraits& traits, uint64_t device_budget)
{
    return slice_bytes(slice_for(traits, device_budget));
}

void Occlusion::create(const DeviceVolume& volume)
{
    const glm::uvec3 slots = volume.atlas_slots();
    const glm::uvec3 of_cells = is_paged_ ? slots : glm::uvec3(brick_counts(volume.info().size));
    slice_ = slice_for(memory_.device().traits(), memory_.device_budget());
    const auto create_image = [&](const char* name, const ResourceDesc& desc) {
        return memory_.create(name, desc, gpu::Placement::device, "ambient occlusion");
    };
    values_ = create_image("occlusion values", image_desc(Format::r8_uint, gpu::BRICK_TEXELS * slots));
    near_ = create_image("occlusion scratch", occlusion_near_desc(slice_, is_paged_));
    for (uint32_t size = 0; size < gpu::OCCLUSION_SIZES; ++size) {
        cells_[size] =
            create_image("occlusion cells", image_desc(Format::r32_uint, (gpu::BRICK_SIZE >> (size + 1)) * of_cells));
        if (is_paged_) around_[size] = create_image("occlusion scratch", occlusion_around_desc(size, slice_));
    }
    images_are_new_ = true;
}

OcclusionBinding Occlusion::bring_up_to_date(FrameGraph& graph)
{
    sync();
    OcclusionBinding binding{.values = graph.import("occlusion values", values_.import())};
    for (size_t size = 0; size < cells_.size(); ++size)
        binding.cells[size] = graph.import("occlusion cells", cells_[size].import());
    std::vector<uint32_t> slots;
    std::vector<BrickKey> keys;
    for (auto& [key, entry] : entries_) {
        if (!std::exchange(entry.is_new, false)) continue;
        slots.push_back(entry.slot);
        keys.push_back(key);
    }
    const bool were_new = std::exchange(images_are_new_, false);
    if (were_new || !keys.empty())
        graph.unless_submitted([this, keys = std::move(keys), were_new] {
            images_are_new_ = images_are_new_ || were_new;
            mark(keys, [](Entry& entry) { entry.is_new = true; });
        });
    if (were_new)
        occlusion_begin(graph, binding);
    else
        occlusion_reset(graph, binding, slots);
    return binding;
}

/// Applies `set` to the entries of `keys`, except for keys without an entry.
template <class Set>
void Occlusion::mark(const std::vector<BrickKey>& keys, const Set& set)
{
    ++changes_;
    for (const BrickKey& key : keys)
        if (const auto found = entries_.find(key); found != entries_.end()) set(found->second);
}

// ---- Invalidation ---------------------------------------------------------------------------------------------------

void Occlusion::look(const Look& look, const DeviceVolume& volume, const DeviceMask& mask)
{
    if (volume_ != &volume) {
        clear();
        is_paged_ = volume.counts().has_value();
        create(volume);
        volume_ = &volume;
    }
    if (std::exchange(mask_, &mask) != &mask)
        for (auto& [key, entry] : entries_) entry.is_seen.reset();
    ++changes_;
    const std::optional<Look> before = std::exchange(look_, look);
    if (!before) return;
    if (!same_function(*before, look) || before->radius != look.radius) return mark_all(true);
    const bool is_other = before->rays != look.rays || before->full_sphere != look.full_sphere ||
                          before->gradient_fade != look.gradient_fade || before->preintegrated != look.preintegrated;
    if (is_other) mark_all(false);
    if (before->groups != look.groups)
        for (const VoxelBox& voxels : mask.bricks(volume.info().size)) changed(voxels);
    mark_cut(before->cut, look.cut);
}

void Occlusion::mark_all(bool cells)
{
    for (auto& [key, entry] : entries_) {
        entry.needs_values = true;
        entry.needs_cells |= cells;
        entry.is_seen.reset();
    }
}

/// Marks bricks between the old and new cutting planes as stale.
void Occlusion::mark_cut(const CutBox& before, const CutBox& after)
{
    const Size3 size = volume_->info().size;
    const auto slab = [&](int axis, double a, double b) {
        if (a == b) return;
        VoxelBox voxels{Size3(0), size};
        voxels.lower[axis] = std::clamp<int64_t>(int64_t(std::floor(std::min(a, b))) - 1, 0, size[axis]);
        voxels.upper[axis] = std::clamp<int64_t>(int64_t(std::ceil(std::max(a, b))) + 1, 0, size[axis]);
        changed(voxels);
    };
    for (int axis = 0; axis < 3; ++axis) {
        slab(axis, before.lower[axis], after.lower[axis]);
        slab(axis, before.upper[axis], after.upper[axis]);
    }
    const glm::dvec3& spacing = volume_->info().spacing;
    const glm::dvec4 was = plane_in_voxels(before, size, spacing), is = plane_in_voxels(after, size, spacing);
    if (was != is) changed_by_planes(was, is);
}

/// Marks bricks with voxels that one of the planes cuts away and the other leaves.
void Occlusion::changed_by_planes(const glm::dvec4& was, const glm::dvec4& is)
{
    const auto extremes = [&](const glm::dvec4& plane, const VoxelBox& box) {
        const glm::dvec3 normal(plane), lower(box.lower), upper(box.upper);
        const double middle = glm::dot(normal, 0.5 * (lower + upper)) + plane.w;
        const double reach = 0.5 * glm::dot(glm::abs(normal), upper - lower + 2.0);  // a voxel to spare on each side
        return std::pair(middle - reach, middle + reach);
    };
    std::vector<VoxelBox> boxes;
    for (const auto& [key, entry] : entries_) {
        const VoxelBox box = voxels_of(key, volume_->info().size);
        const auto [was_least, was_most] = extremes(was, box);
        const auto [is_least, is_most] = extremes(is, box);
        const bool stays_whole = was_most <= 0.0 && is_most <= 0.0, stays_away = was_least > 0.0 && is_least > 0.0;
        if (!stays_whole && !stays_away) boxes.push_back(box);
    }
    for (const VoxelBox& box : boxes) changed(box);
}

void Occlusion::changed(const VoxelBox& changed, int64_t apron)
{
    if (!look_) return;
    ++changes_;
    for (auto& [key, entry] : entries_) {
        // A coarse voxel has the paint of the level 0 voxel at its centre, which may belong to a neighbouring brick.
        const VoxelBox brick = voxels_of(key, volume_->info().size);
        const VoxelBox voxels{changed.lower - (apron << key.level), changed.upper + (apron << key.level)};
        entry.needs_cells = entry.needs_cells || meet(brick, voxels);
        const auto reach = int64_t(std::ceil(look_->radius + std::ldexp(MARGIN_VOXELS, key.level)));
        entry.needs_values = entry.needs_values || meet(brick, {voxels.lower - reach, voxels.upper + reach});
        // The change may show or hide any coarse brick, and any level 0 brick near the change.
        const int64_t beside = int64_t{gpu::BRICK_SIZE} << key.level;
        if (key.level > 0 || meet(brick, {voxels.lower - beside, voxels.upper + beside})) entry.is_seen.reset();
    }
}

/// Synchronizes the entries with the volume's present slots.
void Occlusion::sync()
{
    if (revision_ == volume_->places_revision()) return;
    revision_ = volume_->places_revision();
    ++changes_;
    Entries entries;
    std::vector<BrickKey> arrived;
    for (const DeviceVolume::Place& place : volume_->places()) {
        const auto known = entries_.find(place.key);
        if (known != entries_.end() && known->second.slot == place.slot) {
            Entry& entry = entries.insert(*known).first->second;
            if (entry.range != place.range || (look_ && look_->preintegrated)) entry.is_seen.reset();
            entry.range = place.range;
            continue;
        }
        entries[place.key] = {.slot = place.slot, .range = place.range};
        arrived.push_back(place.key);
    }
    const bool is_first = entries_.empty();
    entries_ = std::move(entries);
    for (size_t i = 0; i < arrived.size() && !is_first; ++i) {
        const BrickKey key = arrived[i];
        for_each_offset(int(occlusion_reach(radius_of(key.level))), [&](const glm::ivec3& offset) {
            const auto neighbour = entries_.find({key.level, key.brick + offset});
            if (neighbour != entries_.end() && !neighbour->second.is_exact) neighbour->second.needs_values = true;
        });
    }
}

double Occlusion::radius_of(int level) const
{
    return std::ldexp(look_->radius, -level);
}

std::vector<int> Occlusion::reach() const
{
    std::vector<int> reach;
    for (int level = 0; look_ && level < volume_->levels(); ++level)
        reach.push_back(int(occlusion_reach(radius_of(level))));
    return reach;
}

/// Whether a brick within `reach` bricks of `key` is painted. For coarse bricks: whether there is any paint at all.
bool Occlusion::is_painted(const BrickKey& key, int reach) const
{
    if (mask_->empty() || key.level > 0) return !mask_->empty();
    const glm::i64vec3 counts(brick_counts(volume_->info().size));
    bool found = false;
    for_each_offset(reach, [&](const glm::ivec3& offset) {
        const glm::i64vec3 at(key.brick + offset);
        const bool is_inside =
            glm::all(glm::greaterThanEqual(at, glm::i64vec3(0))) && glm::all(glm::lessThan(at, counts));
        found = found || (is_inside && mask_->slot_of(index_of(at, counts)) != 0);
    });
    return found;
}

bool Occlusion::shows(const BrickKey& key, const Entry& entry) const
{
    return look_->visibility.shows(entry.range.minimum, entry.range.maximum) || is_painted(key, 0);
}

/// Whether each brick that the values of `key` depend on is on the device, or never will be.
bool Occlusion::has_all_around(const BrickKey& key) const
{
    const glm::ivec3 counts = brick_counts(size_of_level(volume_->info().size, key.level));
    bool is_missing = false;
    for_each_offset(int(occlusion_reach(radius_of(key.level))), [&](const glm::ivec3& offset) {
        const glm::ivec3 at = key.brick + offset;
        const bool is_inside =
            glm::all(glm::greaterThanEqual(at, glm::ivec3(0))) && glm::all(glm::lessThan(at, counts));
        is_missing =
            is_missing || (is_inside && volume_->presence_of({key.level, at}) == DeviceVolume::Presence::missing);
    });
    return !is_missing;
}

/// This function is called for every brick after a change, so cheap checks come first.
bool Occlusion::is_candidate(const BrickKey& key, Entry& entry)
{
    ++counts_.walks;
    if (!entry.needs_values && (!is_paged_ || entry.is_exact)) return false;
    if (!volume_->is_drawn(key) || !is_seen(key, entry)) return false;
    return entry.needs_values || has_all_around(key);
}

bool Occlusion::is_lit(const BrickKey& key)
{
    if (!look_) return true;
    sync();
    const auto found = entries_.find(key);
    if (found == entries_.end()) return false;
    Entry& entry = found->second;
    if (entry.is_exact && !entry.needs_values) return true;
    return has_all_around(key) && !is_seen(key, entry);
}

bool Occlusion::is_seen(const BrickKey& key, Entry& entry)
{
    if (entry.is_seen) return *entry.is_seen;
    ++counts_.looks;
    entry.is_seen = look_whether_seen(key, entry);
    return *entry.is_seen;
}

/// Whether the brick is seen. With pre-integration, an empty brick is seen if any neighbour shows something.
bool Occlusion::look_whether_seen(const BrickKey& key, const Entry& entry) const
{
    if (look_->visibility.shows(entry.range.minimum, entry.range.maximum) || is_painted(key, 1)) return true;
    bool found = false;
    if (look_->preintegrated)
        for_each_offset(1, [&](const glm::ivec3& offset) {
            const auto neighbour = entries_.find({key.level, key.brick + offset});
            found = found || (neighbour != entries_.end() && shows(neighbour->first, neighbour->second));
        });
    return found;
}

bool Occlusion::is_due()
{
    if (!look_) return false;
    sync();
    if (nothing_due_ == cause()) return false;
    if (std::ranges::any_of(entries_, [&](auto& it) { return is_candidate(it.first, it.second); })) return true;
    nothing_due_ = cause();
    return false;
}

/// Queues bricks of a single level: the level of the nearest brick.
void Occlusion::fill_queue(const glm::dvec3& eye)
{
    /// Maximum length of the queue: enough for several slices without another scan of all bricks.
    constexpr size_t MOST = size_t{4} * gpu::OCCLUSION_SLICE;
    queued_ = cause();
    queued_eye_ = eye;
    queue_.clear();
    if (nothing_due_ == queued_) return;
    std::vector<Candidate> candidates;
    for (auto& [key, entry] : entries_) {
        if (!is_candidate(key, entry)) continue;
        const glm::dvec3 centre = std::ldexp(double(gpu::BRICK_SIZE), key.level) * (glm::dvec3(key.brick) + 0.5);
        candidates.push_back({glm::length(centre - eye), key});
    }
    if (candidates.empty()) {
        nothing_due_ = queued_;
        return;
    }
    const auto is_nearer = [](const Candidate& a, const Candidate& b) {
        const auto order = [](const Candidate& c) {
            return std::tuple(c.distance, c.key.level, c.key.brick.z, c.key.brick.y, c.key.brick.x);
        };
        return order(a) < order(b);
    };
    const int level = std::ranges::min_element(candidates, is_nearer)->key.level;
    std::erase_if(candidates, [&](const Candidate& candidate) { return candidate.key.level != level; });
    const size_t most = std::min(MOST, candidates.size());
    std::ranges::partial_sort(candidates, candidates.begin() + std::ptrdiff_t(most), is_nearer);
    candidates.resize(most);
    queue_.assign(candidates.rbegin(), candidates.rend());
}

/// Bricks stay in the queue until they are no longer due.
std::vector<BrickKey> Occlusion::nearest(const glm::dvec3& eye, size_t most)
{
    const auto is_done = [&](const Candidate& candidate) {
        const auto found = entries_.find(candidate.key);
        return found == entries_.end() || !is_candidate(found->first, found->second);
    };
    while (!queue_.empty() && is_done(queue_.back())) queue_.pop_back();
    if (queue_.empty() || queued_ != cause() || queued_eye_ != eye) fill_queue(eye);
    std::vector<BrickKey> keys;
    for (auto each = queue_.rbegin(); each != queue_.rend() && keys.size() < most; ++each)
        if (!is_done(*each)) keys.push_back(each->key);
    return keys;
}

// ---- The work -------------------------------------------------------------------------------------------------------

/// Returns the entry of brick `key` in another brick's table of surrounding bricks (shaders/occlusion/occlusion.h): the
/// slot of the brick or of its finest ancestor on the device, or 0 if it shows nothing. Adds the key found to `keys`.
uint32_t Occlusion::around(const BrickKey& key, std::vector<BrickKey>* keys) const
{
    const glm::ivec3 counts = brick_counts(size_of_level(volume_->info().size, key.level));
    // Empty bricks have no cells, and their apron is never read.
    if (glm::any(glm::lessThan(key.brick, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(key.brick, counts)))
        return 0;
    if (volume_->presence_of(key) == DeviceVolume::Presence::empty) return 0;
    for (BrickKey at = key; at.level < volume_->levels(); at = parent_of(at)) {
        const auto found = entries_.find(at);
        if (found == entries_.end()) continue;
        if (!shows(at, found->second)) return 0;
        if (keys) keys->push_back(at);
        return found->second.slot | uint32_t(at.level - key.level) << gpu::OCCLUSION_LEVEL_SHIFT;
    }
    return 0;
}

std::vector<VoxelBox> Occlusion::next(FrameGraph& graph, const VolumeBinding& volume,
                                      const std::optional<MaskBinding>& mask, const glm::dvec3& eye, const Most& most)
{
    SHVR_CHECK(look_.has_value());
    sync();
    const std::vector<BrickKey> keys = nearest(eye, std::min<size_t>(most.bricks, slice_));
    if (keys.empty()) return {};
    OcclusionBinding images = bring_up_to_date(graph);
    std::vector<BrickKey> needed;
    const int reach = int(occlusion_reach(radius_of(keys.front().level)));
    for (const BrickKey& key : keys)
        for_each_offset(reach, [&](const glm::ivec3& offset) { around({key.level, key.brick + offset}, &needed); });
    std::vector<BrickKey> stale;
    for (const BrickKey& key : needed) {
        Entry& entry = entries_.at(key);
        if (!entry.needs_cells || stale.size() > most.cell_bricks) continue;
        stale.push_back(key);
        entry.needs_cells = false;
    }
    const bool is_enough = stale.size() <= most.cell_bricks;
    if (!is_enough) {
        entries_.at(stale.back()).needs_cells = true;
        stale.pop_back();
    }
    graph.unless_submitted([this, stale] { mark(stale, [](Entry& entry) { entry.needs_cells = true; }); });
    add_cells(graph, volume, images, mask, stale);
    if (!is_enough) return {};
    graph.unless_submitted(
        [this, keys] { mark(keys, [](Entry& entry) { entry.needs_values = true, entry.is_exact = false; }); });
    add_values(graph, volume, images, mask, keys);
    std::vector<VoxelBox> renewed;
    for (const BrickKey& key : keys) {
        VoxelBox voxels = voxels_of(key, volume_->info().size);
        const int64_t apron = int64_t{1} << key.level;
        renewed.push_back({voxels.lower - apron, voxels.upper + apron});
    }
    return renewed;
}

/// Opacities for `stretch` reference lengths.
OcclusionCellsInput Occlusion::cells_input(int level, double stretch, const std::optional<MaskBinding>& mask) const
{
    OcclusionCellsInput input;
    input.params = {.level = uint32_t(level),
                    .lower = glm::max(glm::vec3(look_->cut.lower), glm::vec3(0.0f)),
                    .upper = glm::min(glm::vec3(look_->cut.upper), glm::vec3(volume_->info().size)),
                    .cut_plane = plane_in_voxels(look_->cut, volume_->info().size, volume_->info().spacing),
                    .brick_counts = glm::uvec3(brick_counts(volume_->info().size))};
    const TableRange range = table_range(look_->function, volume_->window(), false);
    set_table(input.params, range);
    glm::dvec2 sums(0.0);
    for (const glm::vec4& entry : bake_table(look_->function, stretch, range.samples).looks) {
        const double opacity = double(entry.a);
        glm::vec2 whole, rest;
        split_digits(sums, whole, rest);
        input.opacities.push_back({entry.a, whole, rest});
        sums += glm::dvec2(opacity, opacity * opacity);
    }
    input.mask = mask;
    for (const double opacity : look_->groups)
        input.group_opacities.push_back(float(opacity_of_step(opacity, stretch)));
    return input;
}

void Occlusion::add_cells(FrameGraph& graph, const VolumeBinding& volume, OcclusionBinding& images,
                          const std::optional<MaskBinding>& mask, const std::vector<BrickKey>& keys)
{
    std::map<int, std::vector<gpu::OcclusionCellsJob>> jobs;
    for (const BrickKey& key : keys) {
        const Entry& entry = entries_.at(key);
        jobs[key.level].push_back({glm::uvec3(key.brick), entry.slot});
    }
    for (const auto& [level, list] : jobs) {
        counts_.cells += list.size();
        const std::array<double, 2> stretches = occlusion_taps_of(volume_->info().spacing, radius_of(level)).stretches;
        OcclusionCellsInput input = cells_input(level, std::ldexp(stretches[0], level), mask);
        input.params.far_exponent = float(0.25 * stretches[1] / stretches[0]);
        occlusion_cells(graph, volume, images, input, list);
    }
}

void Occlusion::add_values(FrameGraph& graph, const VolumeBinding& volume, OcclusionBinding& images,
                           const std::optional<MaskBinding>& mask, const std::vector<BrickKey>& keys)
{
    const int level = keys.front().level;
    const glm::dvec3& spacing = volume_->info().spacing;
    OcclusionInput input{.params = {},
                         .taps = occlusion_taps_of(spacing, radius_of(level), is_paged_),
                         .visible_intervals = look_->visibility.visible_intervals,
                         .near = {}};
    for (int above = 0; above < volume_->levels() - level; ++above)
        for (size_t size = 0; size < gpu::OCCLUSION_SIZES; ++size) {
            const double of_above = occlusion_taps_of(spacing, radius_of(level + above)).stretches[size];
            input.exponents[size * gpu::OCCLUSION_LEVELS + size_t(above)] =
                float(std::ldexp(input.taps.stretches[size] / of_above, -above));
        }
    input.params.table_lower = look_->visibility.params.table_lower;
    input.params.table_upper = look_->visibility.params.table_upper;
    input.params.table_scale = look_->visibility.params.table_scale;
    input.params.table_entries = look_->visibility.params.table_entries;
    input.params.guard = look_->visibility.params.guard;
    input.params.rays = look_->rays;
    // If the radius is below a voxel, there are no near taps, but the tables still need a stretch.
    const double near_stretch = input.taps.taps.empty() ? 1.0 : input.taps.near_stretch;
    input.near = cells_input(level, std::ldexp(near_stretch, level), mask);
    input.params.inverse_spacing = std::min({spacing.x, spacing.y, spacing.z}) / spacing;
    input.params.gradient_fade = float(look_->gradient_fade);
    input.params.full_sphere = look_->full_sphere;
    input.params.grow = mask.has_value() || look_->preintegrated;
    std::vector<gpu::OcclusionJob> jobs;
    std::vector<uint32_t> bricks_around;
    for (const BrickKey& key : keys) {
        Entry& entry = entries_.at(key);
        jobs.push_back({glm::uvec3(key.brick), entry.slot, uint32_t(bricks_around.size())});
        for_each_offset(int(occlusion_reach(radius_of(level))), [&](const glm::ivec3& offset) {
            bricks_around.push_back(around({level, key.brick + offset}, nullptr));
        });
        entry.needs_values = false;
        entry.is_exact = has_all_around(key);
    }
    counts_.values += jobs.size();
    OcclusionScratch scratch{.near = graph.import("occlusion scratch", near_.import())};
    for (size_t size = 0; is_paged_ && size < around_.size(); ++size)
        scratch.around[size] = graph.import("occlusion scratch", around_[size].import());
    occlusion_bake(graph, volume, images, scratch, input, jobs, bricks_around);
}

}  // namespace shvr

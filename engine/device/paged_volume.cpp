#include "engine/device/paged_volume.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <unordered_set>
#include <utility>

namespace shvr {

namespace {

/// Levels with at most this many bricks always stay on the device.
constexpr int64_t COARSE_BRICKS = 64;

int64_t brick_total(const Size3& size, int level)
{
    const glm::i64vec3 counts(brick_counts(size_of_level(size, level)));
    return counts.x * counts.y * counts.z;
}

/// Number of slots for all bricks of all levels, plus the unused slot.
uint64_t useful_slots(const VolumeInfo& info, int levels)
{
    uint64_t useful = 1;
    for (int level = 0; level < levels; ++level)
        useful += uint64_t(std::min<int64_t>(brick_total(info.size, level), int64_t{1} << 40));
    return useful;
}

/// The layout with as many slots as fit into `bytes`, in as few images as can hold these slots.
StackedLayout layout_for(const gpu::DeviceTraits& traits, const VolumeInfo& info, int levels, AtlasCodes codes,
                         uint64_t bytes)
{
    const uint64_t useful = useful_slots(info, levels), most = bytes / BrickAtlas::slot_bytes(codes);
    const uint64_t least = std::min(useful, PagedVolume::MIN_SLOTS);
    // Layouts are rounded up, so a layout for fewer slots may hold more, or exist where none for more slots exists.
    for (uint64_t slots = std::min(useful, most); slots >= least; --slots)
        if (const std::optional<StackedLayout> layout = stacked_layout(slots, codes, traits))
            if (layout->count() <= most) return *layout;
    const std::optional<StackedLayout> smallest = stacked_layout(least, codes, traits);
    if (smallest && most >= least) return *smallest;
    fail(info.name, ": ", gpu::mebibytes(bytes), " of device memory are left for its bricks; expected at least ",
         gpu::mebibytes(PagedVolume::MIN_SLOTS * BrickAtlas::slot_bytes(codes)), ", as a larger --budget-device gives");
}

int kept_levels(int levels)
{
    return std::min(levels, int(gpu::PAGE_MISSING));
}

/// Fails if fewer than half of the slots remain for finer bricks, unless there are slots for all bricks.
void check_coarsest(const VolumeInfo& info, int levels, AtlasCodes codes, uint64_t slots)
{
    const int64_t bricks = brick_total(info.size, levels - 1);
    if (slots < useful_slots(info, levels) && bricks >= int64_t(slots / 2))
        fail(info.name, ": its coarsest level has ", bricks, " bricks and the device has room for ", slots,
             "; expected a coarser level, as `shvr import` makes, or --budget-device ",
             (4 * uint64_t(bricks) * BrickAtlas::slot_bytes(codes) >> 20) + 1);
}

}  // namespace

void PagedVolume::check_room(const gpu::DeviceTraits& traits, const VolumeInfo& info, int levels, AtlasCodes codes,
                             uint64_t device_bytes)
{
    levels = kept_levels(levels);
    check_coarsest(info, levels, codes, layout_for(traits, info, levels, codes, device_bytes).count());
}

PagedVolume::PagedVolume(gpu::Executor& executor, gpu::Memory& memory, std::shared_ptr<const VolumeSource> source,
                         const IntensityWindow& window, const Options& options)
    : DeviceVolume(source->info(), window),
      memory_(memory),
      source_(std::move(source)),
      options_(options),
      levels_(kept_levels(source_->levels())),
      atlas_(executor, memory,
             layout_for(memory.device().traits(), source_->info(), levels_, options.codes, options.device_bytes),
             options.codes),
      slots_(atlas_.slot_count(), [this](const BrickKey& key) { return need_of(key); }),
      known_(info(), levels_, window, source_),
      lister_(known_),
      store_(options.host_bricks ? options.host_bricks
                                 : std::make_shared<BrickStore>(*source_, window, options.host_bytes, options.threads))
{
    cell_leap_ = memory.create("cell leap", image_desc(Format::r8_uint, atlas_.slots() * gpu::BRICK_CELLS),
                               gpu::Placement::device, "the volume");
    pin_coarse_levels();
}

/// Loads the coarsest level, or starts loading it, so that the first picture appears early. Requests the next levels.
void PagedVolume::pin_coarse_levels()
{
    check_coarsest(info(), levels_, options_.codes, slots_.count());
    for (int level = levels_ - 1; level >= 0; --level) {
        if (brick_total(info().size, level) > COARSE_BRICKS && level < levels_ - 1) break;
        const glm::ivec3 counts = brick_counts(size_of_level(info().size, level));
        for (int z = 0; z < counts.z; ++z)
            for (int y = 0; y < counts.y; ++y)
                for (int x = 0; x < counts.x; ++x) {
                    // Pins at most a quarter of the slots, but always the whole coarsest level.
                    if (level < levels_ - 1 && coarse_.size() >= slots_.count() / 4) return;
                    coarse_.push_back({level, {x, y, z}});
                }
        if (level < levels_ - 1) continue;
        if (options_.in_slices) {
            coarsest_ = coarsest_left_ = coarse_.size();
            store_->want(coarse_);
            continue;
        }
        for (const BrickKey& key : coarse_)
            if (const BrickStore::Texels texels = store_->get(key)) place(key, *texels, true);
        atlas_.flush();
    }
}

bool PagedVolume::load_on(double /*seconds*/)
{
    if (coarsest_left_ == 0) return true;
    const std::vector<BrickStore::Finished> finished = store_->take(BrickAtlas::BATCH);
    for (const BrickStore::Finished& brick : finished) {
        if (brick.texels) place(brick.key, *brick.texels, true);
        --coarsest_left_;
    }
    if (!finished.empty()) atlas_.flush();
    return coarsest_left_ == 0;
}

double PagedVolume::loaded() const
{
    return coarsest_ == 0 ? 1.0 : 1.0 - double(coarsest_left_) / double(coarsest_);
}

// ---- The view -------------------------------------------------------------------------------------------------------

/// Rounds `shown` outwards to whole bricks, so that small changes of `shown` rarely need a new list.
PageView PagedVolume::rounded(PageView view) const
{
    constexpr int64_t SIZE = gpu::BRICK_SIZE;
    if (!view.shown || glm::any(glm::greaterThanEqual(view.shown->lower, view.shown->upper))) return view;
    view.shown->lower = view.shown->lower / SIZE * SIZE;
    view.shown->upper = (view.shown->upper + SIZE - int64_t{1}) / SIZE * SIZE;
    return view;
}

bool PagedVolume::get_ready(const PageView& exact, const Visibility& visibility)
{
    const PageView view = rounded(exact);
    if (list_ && !list_is_outdated_ && list_->sight.view == view && list_->sight.visibility == visibility) return true;
    check_camera(view.camera);
    return lister_.get_ready(view, visibility);
}

int PagedVolume::look(const PageView& exact, const Visibility& visibility)
{
    check_camera(exact.camera);
    const PageView view = rounded(exact);
    if (!list_ || list_is_outdated_ || !(list_->sight.view == view) || !(list_->sight.visibility == visibility))
        install(lister_.take(view, visibility));
    return finest_level();
}

/// Makes a list the current one. Brings the previous list up to date, and puts it back into the cache.
void PagedVolume::install(std::shared_ptr<PageList> list)
{
    const std::shared_ptr<PageList> before = std::exchange(list_, std::move(list));
    const bool is_other_look = !before || !(before->sight.visibility == sight().visibility);
    const bool was_outdated = std::exchange(list_is_outdated_, false);
    const bool is_same_view = was_outdated && !is_other_look && before->sight.view == sight().view;
    if (is_other_look) {
        leap_jobs_.clear();
        for (const auto& [key, slot] : slots_.placed()) leap_jobs_.push_back(key);
    }
    is_reached_.assign(tree().leaves.size(), false);
    was_reached_.assign(tree().leaves.size(), false);
    awaited_.clear();
    // Bricks needed in the previous view are likely to be needed again.
    for (const uint32_t leaf : std::exchange(visited_, {})) {
        if (!before || is_other_look) break;
        if (const std::optional<uint32_t> now = leaf_of(before->tree->leaves[leaf].key)) visit(*now, !is_same_view);
    }
    slots_.tick();
    ++reached_revision_;
    is_limited_ = false;
    if (before && !was_outdated) {
        before->has_entries = before->has_entries && !rays_wait_ && !all_leaves_are_stale_;
        lister_.keep(before);
    }
    all_leaves_are_stale_ = rays_wait_ || !list_->has_entries;
    directory_is_stale_ = all_entries_changed_ = true;
    changed_entries_.clear();
    needs_changed();
}

void PagedVolume::look_by(const Visibility& visibility)
{
    if (list_ && !(list_->sight.visibility == visibility)) look(PageView(list_->sight.view), visibility);
}

DeviceVolume::Presence PagedVolume::state_of(const BrickKey& key) const
{
    if (slots_.contains(key)) return Presence::there;
    if (known_.is_empty(sight(), key)) return Presence::empty;
    return store_->failure_of(key) ? Presence::failed : Presence::missing;
}

int64_t PagedVolume::mask_index(const glm::ivec3& brick) const
{
    const glm::i64vec3 counts(brick_counts(info().size));
    return brick.x + counts.x * (brick.y + counts.y * int64_t{brick.z});
}

gpu::BrickLeapJob PagedVolume::job_of(const BrickKey& key, uint32_t slot) const
{
    return {.brick = glm::uvec3(key.brick),
            .level = uint32_t(key.level),
            .slot = atlas_.packed(slot),
            .mask_slot = known_.is_painted(sight(), key)};
}

VolumeBinding PagedVolume::atlas(FrameGraph& graph)
{
    atlas_.flush();
    VolumeBinding volume{.cell_ranges = atlas_.import_cell_ranges(graph), .codes = options_.codes, .in_slots = true};
    atlas_.import_codes(graph, volume);
    return volume;
}

VolumeBinding PagedVolume::prepare(FrameGraph& graph, const DeviceMask& mask, const std::optional<MaskBinding>& painted,
                                   bool feedback)
{
    SHVR_CHECK(list_ != nullptr, "nothing is looked at");
    atlas_.flush();
    VolumeBinding volume{.cell_ranges = atlas_.import_cell_ranges(graph),
                         .brick_counts = glm::uvec3(brick_counts(info().size)),
                         .codes = options_.codes,
                         .in_slots = true};
    atlas_.import_codes(graph, volume);
    volume.pages = PageBinding{.directory = {},
                               .cell_leap = graph.import("cell leap", cell_leap_.import()),
                               .reached = {},
                               .feedback = feedback,
                               .counts = tree().counts,
                               .cell_shift = uint32_t(tree().cell_shift),
                               .depth = uint32_t(tree().depth)};
    add_leaps(graph, volume, mask, painted);
    volume.pages->directory = upload_directory(graph);
    const uint64_t words = feedback ? std::bit_ceil((tree().entries.size() + 31) / 32) : 1;
    volume.pages->reached =
        graph.fill(graph.create("reached", buffer_desc(words * sizeof(uint32_t))), 0, "clear reached");
    return volume;
}

/// Computes the leap distances of new bricks and of bricks whose look has changed.
void PagedVolume::add_leaps(FrameGraph& graph, VolumeBinding& volume, const DeviceMask& mask,
                            const std::optional<MaskBinding>& painted)
{
    if (leap_jobs_.empty()) return;
    std::vector<gpu::BrickLeapJob> jobs;
    const auto keys = std::make_shared<const std::vector<BrickKey>>(std::exchange(leap_jobs_, {}));
    graph.unless_submitted([this, keys] { leap_jobs_.insert(leap_jobs_.end(), keys->begin(), keys->end()); });
    std::unordered_set<BrickKey, BrickKeyHash> done;
    for (const BrickKey& key : *keys) {
        const std::optional<uint32_t> slot = slots_.find(key);
        if (!slot || !done.insert(key).second) continue;
        jobs.push_back(job_of(key, *slot));
        if (key.level == 0 && !mask.empty() && sight().visibility.params.paint_reach == 0)
            jobs.back().mask_slot = mask.slot_of(mask_index(key.brick));
    }
    brick_leap(graph, volume, sight().visibility, painted, jobs);
}

DeviceVolume::Feedback PagedVolume::request_feedback(FrameGraph& graph, const VolumeBinding& volume) const
{
    Feedback feedback;
    feedback.read_back_ = graph.read_back(volume.pages->reached, "what rays came by");
    feedback.tree_ = list_->tree;
    return feedback;
}

void PagedVolume::take_feedback(const Feedback& feedback, const gpu::FrameResult& result)
{
    if (feedback.read_back_) note_reached(feedback.tree_, result.read_backs[*feedback.read_back_]);
}

/// `bits`: the contents of PageBinding::reached after a picture drawn with the tree `drawn`.
void PagedVolume::note_reached(const std::shared_ptr<const PageTree>& drawn, std::span<const std::byte> bits)
{
    for (size_t word = 0; word < bits.size() / sizeof(uint32_t); ++word) {
        uint32_t set = 0;
        std::memcpy(&set, bits.data() + word * sizeof(uint32_t), sizeof set);
        for (; set != 0; set &= set - 1) {
            const size_t entry = 32 * word + size_t(std::countr_zero(set));
            if (entry >= drawn->leaf_of_entry.size()) break;
            uint32_t leaf = drawn->leaf_of_entry[entry];
            if (leaf == PageTree::NO_LEAF) continue;
            if (drawn != list_->tree) {  // the view has moved since
                const std::optional<uint32_t> now = leaf_of(drawn->leaves[leaf].key);
                if (!now) continue;
                leaf = *now;
            }
            if (is_reached_[leaf]) continue;
            visit(leaf, false);
            const BrickKey& key = tree().leaves[leaf].key;
            slots_.use(key);
            if (rays_wait_ && state_of(key) == Presence::failed) {
                given_up_.insert(key);
                note_changed(key);
            }
            ++reached_revision_;
            wants_are_stale_ = true;
        }
    }
}

}  // namespace shvr

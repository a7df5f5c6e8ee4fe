// Paged bricks (paged_volume.h): the directory that rays read (shaders/pages.h), and its updates as bricks arrive.

#include <algorithm>
#include <bit>
#include <utility>

#include "engine/device/paged_volume.h"

namespace shvr {

/// The directory's entry for a leaf. If rays wait for missing bricks, the entry may tell them to wait.
uint32_t PagedVolume::entry_of(const BrickKey& leaf) const
{
    if (rays_wait_) {
        const Presence state = state_of(leaf);
        if (state == Presence::missing || (state == Presence::failed && !given_up_.contains(leaf)) ||
            (state == Presence::there && is_ready_ && !is_ready_(leaf)))
            return gpu::PAGE_MISSING << gpu::PAGE_LEVEL_SHIFT;
    }
    return known_.entry_of(sight(), leaf);
}

void PagedVolume::set_entry(uint32_t entry, uint32_t value)
{
    if (std::exchange(list_->entries[entry], value) != value && !all_entries_changed_)
        changed_entries_.push_back(entry);
}

void PagedVolume::fill_leaf(uint32_t leaf)
{
    ++leaves_looked_up_;
    const uint32_t entry = entry_of(tree().leaves[leaf].key);
    for (uint32_t i = tree().begin_of_leaf[leaf]; i < tree().begin_of_leaf[leaf + 1]; ++i)
        set_entry(tree().entries_of_leaves[i], entry);
}

/// Brings the entries below a brick that has arrived or was evicted up to date. The leaves whose finest brick it is, or
/// was, all show the same now, so only those that show no brick are looked up.
void PagedVolume::fill_below(const BrickKey& key)
{
    const uint32_t now = known_.finest_entry(key);
    for_each_entry_below(tree(), key, [&](uint32_t entry, uint32_t leaf) {
        const uint32_t shown = list_->entries[entry], level = shown >> gpu::PAGE_LEVEL_SHIFT;
        if (level < uint32_t(key.level)) return;  // a finer one
        if (level < gpu::PAGE_MISSING) return set_entry(entry, now);
        ++leaves_looked_up_;
        set_entry(entry, entry_of(tree().leaves[leaf].key));
    });
}

/// Brings the list's entries up to date.
void PagedVolume::fill_directory()
{
    const auto changes = lister_.changes_since(list_->changes);
    if (std::exchange(all_leaves_are_stale_, false) || !changes) {
        all_entries_changed_ = true;
        for (uint32_t leaf = 0; leaf < tree().leaves.size(); ++leaf) fill_leaf(leaf);
        list_->has_entries = true;
    } else {
        for (const BrickEvent& change : *changes) {
            if (const std::optional<uint32_t> leaf = leaf_of(change.key)) {
                fill_leaf(*leaf);
            } else if (change.kind == BrickEvent::Kind::placed || change.kind == BrickEvent::Kind::gone) {
                fill_below(change.key);
            }
        }
    }
    list_->changes = lister_.changes();
}

void PagedVolume::note_all_changed()
{
    directory_is_stale_ = all_leaves_are_stale_ = true;
}

void PagedVolume::note(const BrickEvent& change)
{
    known_.apply(change);
    lister_.note(change);
    directory_is_stale_ = true;
    // Rays that wait for a brick's light also wait for its neighbours, so entries of other leaves may change as well.
    if (is_ready_) all_leaves_are_stale_ = true;
    const bool may_be_missing = change.kind == BrickEvent::Kind::gone || change.kind == BrickEvent::Kind::unread;
    if (const std::optional<uint32_t> leaf = may_be_missing ? leaf_of(change.key) : std::nullopt)
        if (is_visited(*leaf)) awaited_.insert(*leaf);
}

Resource PagedVolume::upload_directory(FrameGraph& graph)
{
    if (!std::exchange(directory_is_stale_, false)) return graph.import("page directory", directory_.import());
    graph.unless_submitted([this] { directory_is_stale_ = all_entries_changed_ = true; });
    fill_directory();
    const uint64_t bytes = list_->entries.size() * sizeof(uint32_t);
    if (!directory_ || directory_.desc().bytes < bytes) {
        directory_.reset();
        directory_ = memory_.create("page directory", buffer_desc(bytes), gpu::Placement::device, "the view");
        all_entries_changed_ = true;
    }
    const Resource directory = graph.import("page directory", directory_.import());
    std::vector<uint32_t> changed = std::exchange(changed_entries_, {}), values;
    std::vector<BufferRegion> regions;
    if (!all_entries_changed_) regions = changed_regions(std::move(changed), values);
    if (std::exchange(all_entries_changed_, false) || values.size() > list_->entries.size() / 4) {
        directory_bytes_ += bytes;
        return graph.copy(graph.upload<uint32_t>("page directory entries", list_->entries), directory, {{0, 0, bytes}},
                          "upload page directory");
    }
    if (regions.empty()) return directory;
    directory_bytes_ += values.size() * sizeof(uint32_t);
    values.resize(std::bit_ceil(values.size()));
    return graph.copy(graph.upload<uint32_t>("page directory entries", values), directory, std::move(regions),
                      "upload page directory");
}

/// Returns the copies that upload these entries. Appends the data to be copied to `values`.
std::vector<BufferRegion> PagedVolume::changed_regions(std::vector<uint32_t> entries,
                                                       std::vector<uint32_t>& values) const
{
    constexpr uint32_t GAP = 16;  // in entries; copying a few unchanged entries costs less than another copy region
    std::ranges::sort(entries);
    std::vector<BufferRegion> regions;
    for (size_t first = 0, end = 0; first < entries.size(); first = end) {
        for (end = first + 1; end < entries.size() && entries[end] <= entries[end - 1] + GAP;) ++end;
        const uint32_t begin = entries[first], count = entries[end - 1] + 1 - begin;
        regions.push_back({values.size() * sizeof(uint32_t), begin * sizeof(uint32_t), count * sizeof(uint32_t)});
        values.insert(values.end(), list_->entries.begin() + begin, list_->entries.begin() + begin + count);
    }
    return regions;
}

}  // namespace shvr

#include "engine/look/surfaces/surface_forest.h"

#include <algorithm>

#include "engine/base/error.h"

namespace shvr {

SurfaceForest::SurfaceForest(std::vector<KeyedSurface> surfaces, const VolumeInfo& volume, size_t max_in_leaf)
    : max_in_leaf_(max_in_leaf)
{
    SurfaceTree tree = surface_tree(surfaces, volume, max_in_leaf);
    nodes_ = std::move(tree.nodes);
    list_ = std::move(tree.list);
    keys_ = std::move(tree.keys);
    base_nodes_ = nodes_.size();
    base_list_ = list_.size();
    if (!may_grow()) return;
    nodes_.reserve(max_nodes());
    list_.reserve(max_surfaces());
    leaves_.resize(base_list_);
    for (uint32_t node = 0; node < base_nodes_; ++node)
        for (uint32_t i = nodes_[node].begin; i < nodes_[node].end; ++i) leaves_[i] = node;
    places_.reserve(base_list_);
    for (uint32_t i = 0; i < base_list_; ++i) places_.push_back({keys_[i], i});
    std::ranges::sort(places_, {}, &Place::key);
}

/// Removes a surface from the large hierarchy. The last surface of the same leaf moves to its place in the list.
void SurfaceForest::remove(uint64_t key)
{
    const auto found = std::ranges::lower_bound(places_, key, {}, &Place::key);
    if (found == places_.end() || found->key != key || found->at == GONE) return;
    const uint32_t at = std::exchange(found->at, GONE), leaf = leaves_[at];
    const uint32_t last = --nodes_[leaf].end;
    written_.nodes.push_back(leaf);
    if (last == at) return;
    list_[at] = list_[last];
    keys_[at] = keys_[last];
    std::ranges::lower_bound(places_, keys_[at], {}, &Place::key)->at = at;
    written_.list.push_back(at);
}

bool SurfaceForest::replace(std::span<const uint64_t> keys, std::span<const KeyedSurface> surfaces,
                            const VolumeInfo& volume)
{
    if (!may_grow() || keys.size() > MAX_SURFACES_ADDED || surfaces.size() > MAX_SURFACES_ADDED) return false;
    std::vector<uint64_t> gone(keys.begin(), keys.end());
    for (const KeyedSurface& surface : surfaces) gone.push_back(surface.key);
    std::ranges::sort(gone);
    std::vector<KeyedSurface> added = added_;
    std::erase_if(added, [&](const KeyedSurface& surface) { return std::ranges::binary_search(gone, surface.key); });
    added.insert(added.end(), surfaces.begin(), surfaces.end());
    std::ranges::sort(added, {}, &KeyedSurface::key);
    if (added.size() > MAX_SURFACES_ADDED) return false;
    const SurfaceTree tree = surface_tree(added, volume, max_in_leaf_);

    added_ = std::move(added);
    for (const uint64_t key : gone) remove(key);
    set_added(tree);
    return true;
}

/// Replaces the small hierarchy, built from `added_`.
void SurfaceForest::set_added(const SurfaceTree& tree)
{
    nodes_.resize(base_nodes_);
    list_.resize(base_list_);
    for (gpu::SurfaceNode node : tree.nodes) {
        node.skip += uint32_t(base_nodes_);
        node.begin += uint32_t(base_list_);
        node.end += uint32_t(base_list_);
        written_.nodes.push_back(uint32_t(nodes_.size()));
        nodes_.push_back(node);
    }
    for (const gpu::Surface& surface : tree.list) {
        written_.list.push_back(uint32_t(list_.size()));
        list_.push_back(surface);
    }
    SHVR_CHECK(nodes_.size() <= max_nodes() && list_.size() <= max_surfaces());
}

namespace {

bool is_placed_alike(const gpu::Surface& a, const gpu::Surface& b)
{
    return a.from == b.from && a.from_rest == b.from_rest && a.along == b.along && a.radius_from == b.radius_from &&
           a.radius_to == b.radius_to;
}

}  // namespace

bool SurfaceForest::restyle(std::span<const KeyedSurface> surfaces, const VolumeInfo& volume)
{
    if (!may_grow()) return false;
    // `places_`, `added` and `surfaces` are all sorted by key, so one loop can walk through them in parallel.
    std::vector<std::pair<uint32_t, gpu::Surface>> other;
    std::vector<KeyedSurface> added = added_;
    size_t place = 0, of_added = 0;
    bool is_moved = false, is_added_other = false;
    for (const KeyedSurface& surface : surfaces) {
        while (place < places_.size() && places_[place].at == GONE) ++place;
        if (place < places_.size() && places_[place].key == surface.key) {
            const uint32_t at = places_[place++].at;
            const gpu::Surface now = surface_on_device(surface, volume);
            const bool is_placed = is_placed_alike(now, list_[at]);
            is_moved = is_moved || !is_placed;
            if (!is_placed || now.color != list_[at].color) other.emplace_back(at, now);
        } else if (of_added < added.size() && added[of_added].key == surface.key) {
            is_added_other = is_added_other || added[of_added].look != surface.look;
            added[of_added++].look = surface.look;
        } else {
            return false;
        }
    }
    while (place < places_.size() && places_[place].at == GONE) ++place;
    if (place < places_.size() || of_added < added.size()) return false;
    const SurfaceTree tree = is_added_other ? surface_tree(added, volume, max_in_leaf_) : SurfaceTree();

    for (const auto& [at, now] : other) {
        list_[at] = now;
        written_.list.push_back(at);
    }
    if (is_moved) {
        const std::vector<uint32_t> changed = refit(std::span(nodes_).first(base_nodes_), list_);
        written_.nodes.insert(written_.nodes.end(), changed.begin(), changed.end());
    }
    if (is_added_other) {
        added_ = std::move(added);
        set_added(tree);
    }
    return true;
}

}  // namespace shvr

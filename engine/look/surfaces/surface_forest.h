#pragma once
// The surfaces of a scene, with cheap changes of a few at a time. Surfaces are only removed from a large hierarchy of
// boxes; surfaces added since are in a small hierarchy, which follows and is rebuilt on each change. A search continues
// from the large hierarchy into the small one, so kernels see one hierarchy. Plain data; one thread at a time.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "engine/look/surfaces/surface_tree.h"

namespace shvr {

class SurfaceForest {
public:
    /// Maximum number of surfaces in the small hierarchy, which then takes two milliseconds to build.
    static constexpr size_t MAX_SURFACES_ADDED = 2048;

    SurfaceForest() = default;
    /// Keys must be unique. Fails under the same conditions as `surface_tree`. `max_in_leaf` is only set by tests.
    SurfaceForest(std::vector<KeyedSurface> surfaces, const VolumeInfo& volume,
                  size_t max_in_leaf = gpu::SURFACES_IN_LEAF);

    /// Removes the surfaces with `keys`, as far as present, and adds `surfaces`. Returns false, without a change, if
    /// building a new forest is as cheap. Fails like `surface_tree`, also without a change. Memory and time are
    /// proportional to the changes and MAX_SURFACES_ADDED, not to the size of the forest.
    bool replace(std::span<const uint64_t> keys, std::span<const KeyedSurface> surfaces, const VolumeInfo& volume);

    /// Changes the looks of existing surfaces; `surfaces`, sorted by key, must contain all of them. Returns false,
    /// without a change, if the keys differ or if building a new forest is as cheap. Fails like `surface_tree`, also
    /// without a change. Writes only the surfaces that look different, and the boxes whose size changes.
    bool restyle(std::span<const KeyedSurface> surfaces, const VolumeInfo& volume);

    const std::vector<gpu::SurfaceNode>& nodes() const { return nodes_; }
    const std::vector<gpu::Surface>& list() const { return list_; }
    /// Returns an upper bound for the number of nodes after any number of calls of `replace`.
    size_t max_nodes() const { return base_nodes_ + (may_grow() ? 2 * MAX_SURFACES_ADDED : 0); }
    size_t max_surfaces() const { return base_list_ + (may_grow() ? MAX_SURFACES_ADDED : 0); }

    /// Indices into `nodes` and `list` of the elements written since the last `take_written`; may contain duplicates.
    struct Written {
        std::vector<uint32_t> nodes, list;
    };
    Written take_written() { return std::exchange(written_, {}); }

private:
    /// Whether the forest is large enough for changes; a smaller forest is rebuilt as fast as the small hierarchy.
    bool may_grow() const { return base_list_ > 2 * MAX_SURFACES_ADDED; }
    void remove(uint64_t key);
    void set_added(const SurfaceTree& tree);

    size_t max_in_leaf_ = gpu::SURFACES_IN_LEAF;
    std::vector<gpu::SurfaceNode> nodes_;
    std::vector<gpu::Surface> list_;
    size_t base_nodes_ = 0, base_list_ = 0;  ///< sizes of the large hierarchy's part, which comes first
    std::vector<uint64_t> keys_;             ///< keys of the large hierarchy's surfaces, in the order of `list_`
    std::vector<uint32_t> leaves_;           ///< for each surface in `keys_`, its leaf's index in `nodes_`
    /// A key of the large hierarchy, and its index in `list_` (GONE: removed). `places_` is sorted by key.
    struct Place {
        uint64_t key;
        uint32_t at;
    };
    static constexpr uint32_t GONE = ~0u;
    std::vector<Place> places_;
    std::vector<KeyedSurface> added_;  ///< sorted by key
    Written written_;
};

}  // namespace shvr

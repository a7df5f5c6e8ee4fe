#pragma once
// The surfaces of a scene, of which a few change at a time: a large hierarchy of boxes that loses some, followed by a
// small one of those that came since, which is made anew. A search that has passed the first goes on with the second,
// so kernels need not know. Plain data; one thread at a time.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "engine/look/surface_tree.h"

namespace shvr {

class SurfaceForest {
public:
    /// That many surfaces are in the small hierarchy at most: two milliseconds to make.
    static constexpr size_t MOST_ADDED = 2048;

    SurfaceForest() = default;
    /// Different keys. Fails as `surface_tree` does. `most_in_leaf` is for tests.
    SurfaceForest(std::vector<KeyedSurface> surfaces, const VolumeInfo& volume, size_t most_in_leaf = SURFACES_IN_LEAF);

    /// Those of `keys` go, where they are there, and `surfaces` come. False: nothing changed, since a new forest is as
    /// cheap. Fails as `surface_tree` does, and then nothing changed. Memory and time follow what is small: the
    /// changes, and MOST_ADDED.
    bool replace(std::span<const uint64_t> keys, std::span<const KeyedSurface> surfaces, const VolumeInfo& volume);

    const std::vector<gpu::SurfaceNode>& nodes() const { return nodes_; }
    const std::vector<gpu::Surface>& list() const { return list_; }
    /// So many of them there may be, whatever `replace` does.
    size_t most_nodes() const { return base_nodes_ + (may_grow() ? 2 * MOST_ADDED : 0); }
    size_t most_surfaces() const { return base_list_ + (may_grow() ? MOST_ADDED : 0); }

    /// Places in `nodes` and `list` that `replace` wrote to since the last call; some may be there twice.
    struct Written {
        std::vector<uint32_t> nodes, list;
    };
    Written take_written() { return std::exchange(written_, {}); }

private:
    /// Of fewer, a new hierarchy is made as fast as the small one.
    bool may_grow() const { return base_list_ > 2 * MOST_ADDED; }
    void remove(uint64_t key);

    size_t most_in_leaf_ = SURFACES_IN_LEAF;
    std::vector<gpu::SurfaceNode> nodes_;
    std::vector<gpu::Surface> list_;
    size_t base_nodes_ = 0, base_list_ = 0;  ///< of the large hierarchy, which is in front
    std::vector<uint64_t> keys_;             ///< of its surfaces, as they lie in `list_`
    std::vector<uint32_t> leaves_;           ///< and their nodes
    /// Its keys in order with their places in `list_`; GONE: it was removed.
    struct Place {
        uint64_t key;
        uint32_t at;
    };
    static constexpr uint32_t GONE = ~0u;
    std::vector<Place> places_;
    std::vector<KeyedSurface> added_;  ///< by key
    Written written_;
};

}  // namespace shvr

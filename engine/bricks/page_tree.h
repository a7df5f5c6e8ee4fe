#pragma once
// Determines which bricks a picture needs: the tree of a volume's bricks, cut where they are as fine as the screen can
// show, without bricks that are outside the view, cut away or invisible under the transfer function. Plain data,
// computed in double on the CPU; no device.
//
// A brick is fine enough when its voxel size along the finest axis is at most 1 / `detail` times the size of a pixel at
// the brick's nearest point. This depends on the view alone, never on loaded bricks or a budget, so pictures under
// different budgets are equal.

#include <functional>

#include "engine/look/camera.h"
#include "engine/look/settings.h"
#include "engine/volume/brick_key.h"

namespace shvr {

struct PageView {
    Camera camera;
    std::optional<Camera> other_eye;
    glm::uvec2 pixels{1};
    double detail = 1.0;  ///< minimum voxels per pixel; 0: the finest level everywhere
    CutBox cut;
    bool shows_all = false;  ///< ignore the transfer function
    /// Bricks that overlap this box are always shown.
    std::optional<VoxelBox> shown{};
    bool operator==(const PageView&) const = default;
};

struct PageTree {
    struct Leaf {
        BrickKey key;
        double depth = 0.0;  ///< depth of the brick's nearest point along the view; near bricks load first
    };
    static constexpr uint32_t NO_LEAF = 0xffffffffu;

    std::vector<Leaf> leaves;  ///< nearest first
    int finest_level = 0;      ///< the finest level of all leaves; determines the sample distance
    int cell_shift = 5;        ///< log2 of the side of a cell of the directory's grid, in voxels
    glm::uvec3 counts{1};      ///< cells of the grid
    int depth = 0;             ///< levels of nodes below the grid
    /// The directory of shaders/pages.h, as far as the view determines it: empty space, and the nodes. For an entry
    /// whose `leaf_of_entry` names a leaf, the caller fills in the brick to draw.
    std::vector<uint32_t> entries;
    std::vector<uint32_t> leaf_of_entry;
    /// The inverse mapping: leaf i is in `entries_of_leaves`[`begin_of_leaf`[i] ... `begin_of_leaf`[i + 1] - 1].
    std::vector<uint32_t> entries_of_leaves, begin_of_leaf;
};

/// `levels`: as VolumeSource::levels. `shows`: whether a brick, or any of the finer bricks below it, may have visible
/// voxels. If a view needs more than `max_leaves` leaves, its detail is halved until they suffice.
PageTree make_page_tree(const VolumeInfo& volume, int levels, const PageView& view,
                        const std::function<bool(const BrickKey&)>& shows, size_t max_leaves = size_t{1} << 17);

/// Visits the directory entries of all leaves at or below a brick, each entry once.
void for_each_entry_below(const PageTree& tree, const BrickKey& key,
                          const std::function<void(uint32_t entry, uint32_t leaf)>& visit);

}  // namespace shvr

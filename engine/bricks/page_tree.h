#pragma once
// Determines which bricks a picture needs: the tree of a volume's bricks, cut where the bricks are as fine as the
// screen can show, without bricks that are outside the view, cut away or invisible under the transfer function. Plain
// data, computed in double on the CPU; no device.
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
    /// Bricks that overlap this box are shown even if the look hides them.
    std::optional<VoxelBox> shown{};
    bool operator==(const PageView&) const = default;
};

struct PageTree {
    struct Leaf {
        BrickKey key;
        double depth = 0.0;  ///< depth of the brick's nearest point in the view; near bricks load first
    };
    static constexpr uint32_t NO_LEAF = 0xffffffffu;

    std::vector<Leaf> leaves;  ///< nearest first
    int finest_level = 0;      ///< the finest level among the leaves; determines the sample distance
    int cell_shift = 5;        ///< log2 of the side of a cell of the directory's grid, in voxels
    glm::uvec3 counts{1};      ///< cells of the grid
    int depth = 0;             ///< levels of nodes below the grid
    /// The part of the directory (shaders/pages.h) that the view determines: empty space and nodes. For an entry that
    /// belongs to a leaf (`leaf_of_entry`), the caller fills in the brick to draw.
    std::vector<uint32_t> entries;
    std::vector<uint32_t> leaf_of_entry;
    /// Inverse of `leaf_of_entry`: leaf i has `entries_of_leaves`[`begin_of_leaf`[i] ... `begin_of_leaf`[i + 1] - 1].
    std::vector<uint32_t> entries_of_leaves, begin_of_leaf;
};

/// `levels`: as VolumeSource::levels. `shows`: whether a brick, or any finer brick below it, may have visible voxels.
/// If a view needs more than `max_leaves` leaves, halves the view's detail until `max_leaves` suffice.
PageTree make_page_tree(const VolumeInfo& volume, int levels, const PageView& view,
                        const std::function<bool(const BrickKey&)>& shows, size_t max_leaves = size_t{1} << 17);

/// Visits the directory entries of all leaves at or below a brick, each entry once.
void for_each_entry_below(const PageTree& tree, const BrickKey& key,
                          const std::function<void(uint32_t entry, uint32_t leaf)>& visit);

}  // namespace shvr

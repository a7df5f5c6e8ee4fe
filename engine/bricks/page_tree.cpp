#include "engine/bricks/page_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/base/error.h"
#include "engine/bricks/brick_builder.h"
#include "shaders/pages.h"

namespace shvr {

namespace {

struct Box {
    glm::dvec3 lower, upper;
};

/// Minimum of dot(normal, p) over a box.
double least(const glm::dvec3& normal, const Box& box)
{
    double sum = 0.0;
    for (int axis = 0; axis < 3; ++axis) sum += normal[axis] * (normal[axis] > 0.0 ? box.lower[axis] : box.upper[axis]);
    return sum;
}

double most(const glm::dvec3& normal, const Box& box)
{
    return -least(-normal, box);
}

/// The region that a picture's rays can reach, in physical units, and the size of a pixel at each depth.
class Frustum {
public:
    Frustum(const Camera& camera, const glm::uvec2& pixels) : camera_(camera), pixels_(pixels)
    {
        forward_ = glm::normalize(camera_.target - camera_.eye);
        const glm::dvec3 right = glm::normalize(glm::cross(forward_, camera_.up));
        const glm::dvec3 up = glm::cross(right, forward_);
        const bool is_perspective = camera_.projection == Camera::Projection::perspective;
        const double half = is_perspective ? std::tan(glm::radians(0.5 * camera_.fov_y_degrees)) : 0.5 * camera_.height;
        // Adds a pixel on each side, so that rounding cannot cut off rays at the border.
        const glm::dvec2 margin = (glm::dvec2(pixels_) + 2.0) / glm::dvec2(pixels_);
        const double half_y = half * margin.y;
        const double half_x = half * margin.x * double(pixels_.x) / double(pixels_.y);
        pixel_ = 2.0 * half / double(pixels_.y);
        size_t plane = 0;
        const double shift = 2.0 * half * camera_.shift_right;
        for (const auto& [side, extent] : {std::pair{right, half_x + shift}, std::pair{-right, half_x - shift},
                                           std::pair{up, half_y}, std::pair{-up, half_y}}) {
            // Inside where dot(normal, p) >= offset.
            const glm::dvec3 normal = is_perspective ? extent * forward_ - side : -side;
            const double offset = glm::dot(normal, camera_.eye) - (is_perspective ? 0.0 : extent);
            planes_[plane++] = {normal, offset};
        }
        eye_depth_ = glm::dot(forward_, camera_.eye);
    }

    bool meets(const Box& box) const
    {
        for (const auto& [normal, offset] : planes_)
            if (most(normal, box) < offset) return false;
        if (most(forward_, box) - eye_depth_ < camera_.near_distance) return false;
        return camera_.far_distance <= 0.0 || least(forward_, box) - eye_depth_ <= camera_.far_distance;
    }
    double depth(const Box& box) const { return std::max(least(forward_, box) - eye_depth_, camera_.near_distance); }
    /// Size of a pixel at `depth`, in physical units.
    double pixel_at(double depth) const
    {
        return camera_.projection == Camera::Projection::perspective ? pixel_ * std::max(depth, 0.0) : pixel_;
    }

private:
    struct Plane {
        glm::dvec3 normal;
        double offset;
    };
    Camera camera_;
    glm::uvec2 pixels_;
    glm::dvec3 forward_{0.0};
    double pixel_ = 0.0;
    double eye_depth_ = 0.0;
    std::array<Plane, 4> planes_;
};

class Cutter {
public:
    Cutter(const VolumeInfo& volume, int levels, const PageView& view,
           const std::function<bool(const BrickKey&)>& shows, size_t max_leaves)
        : volume_(volume), levels_(levels), view_(view), shows_(shows), max_leaves_(max_leaves)
    {
        frustums_.emplace_back(view.camera, view.pixels);
        if (view.other_eye) frustums_.emplace_back(*view.other_eye, view.pixels);
        reference_ = std::min({volume.spacing.x, volume.spacing.y, volume.spacing.z});
        beyond_ = plane_in_voxels(view.cut, volume.size, volume.spacing);
    }

    /// Lists the leaves for `detail`. Returns false if there are too many.
    bool cut(double detail)
    {
        detail_ = detail;
        leaves_.clear();
        const int root = levels_ - 1;
        const glm::ivec3 roots = brick_counts(size_of_level(volume_.size, root));
        for (int z = 0; z < roots.z; ++z)
            for (int y = 0; y < roots.y; ++y)
                for (int x = 0; x < roots.x; ++x)
                    if (!visit({root, {x, y, z}})) return false;
        return true;
    }
    std::vector<PageTree::Leaf>& leaves() { return leaves_; }

private:
    /// The coarsest level that is fine enough at a depth.
    int level_at(const Frustum& frustum, double depth) const
    {
        if (detail_ <= 0.0) return 0;
        const double voxels = frustum.pixel_at(depth) / (detail_ * reference_);
        return voxels < 2.0 ? 0 : std::min(int(std::floor(std::log2(voxels))), levels_ - 1);
    }

    /// Whether the oblique plane cuts away a box of voxels with room to spare for rounding.
    bool is_beyond_plane(const glm::dvec3& lower, const glm::dvec3& upper) const
    {
        const glm::dvec3 along(beyond_), nearest = glm::mix(lower, upper, glm::lessThan(along, glm::dvec3(0.0)));
        return glm::dot(along, nearest) + beyond_.w > 0.5 * reference_;
    }

    bool visit(const BrickKey& key)
    {
        const VoxelBox voxels = voxels_of(key, volume_.size);
        if (glm::any(glm::greaterThanEqual(voxels.lower, voxels.upper))) return true;  // outside the volume
        const glm::dvec3 lower(voxels.lower), upper(voxels.upper);
        if (glm::any(glm::lessThan(upper, view_.cut.lower)) || glm::any(glm::greaterThan(lower, view_.cut.upper)))
            return true;
        if (is_beyond_plane(lower, upper)) return true;
        const Box box{lower * volume_.spacing, upper * volume_.spacing};
        double depth = std::numeric_limits<double>::infinity();
        int level = levels_;
        for (const Frustum& frustum : frustums_) {
            if (!frustum.meets(box)) continue;
            const double seen_at = frustum.depth(box);
            depth = std::min(depth, seen_at);
            level = std::min(level, level_at(frustum, seen_at));
        }
        if (level == levels_ || !shows_(key)) return true;
        if (key.level <= level) {
            leaves_.push_back({key, depth});
            return leaves_.size() <= max_leaves_;
        }
        for (int child = 0; child < 8; ++child)
            if (!visit({key.level - 1, 2 * key.brick + glm::ivec3(child & 1, child >> 1 & 1, child >> 2)}))
                return false;
        return true;
    }

    const VolumeInfo& volume_;
    int levels_;
    const PageView& view_;
    std::vector<Frustum> frustums_;  ///< one per eye
    const std::function<bool(const BrickKey&)>& shows_;
    size_t max_leaves_;
    double reference_ = 1.0;
    glm::dvec4 beyond_{0.0};  ///< distance beyond the oblique cutting plane, of a voxel
    double detail_ = 1.0;
    std::vector<PageTree::Leaf> leaves_;
};

/// The entry of an empty cell, `distance` cells from the nearest non-empty cell.
uint32_t empty_entry(uint32_t distance)
{
    return distance << gpu::PAGE_DISTANCE_SHIFT;
}

/// Finds or creates the entry of a leaf that is finer than the grid.
uint32_t entry_below(PageTree& tree, uint32_t entry, int shift, const BrickKey& key)
{
    const int leaf_shift = key.level + 5;
    while (shift > leaf_shift) {
        if (tree.entries[entry] >> gpu::PAGE_LEVEL_SHIFT != gpu::PAGE_NODE) {
            tree.entries[entry] = gpu::PAGE_NODE << gpu::PAGE_LEVEL_SHIFT | uint32_t(tree.entries.size());
            tree.entries.resize(tree.entries.size() + 8, empty_entry(1));
        }
        --shift;
        const glm::ivec3 half = key.brick >> (shift - leaf_shift) & 1;
        entry = (tree.entries[entry] & gpu::PAGE_PAYLOAD_MASK) + uint32_t(half.x + 2 * half.y + 4 * half.z);
    }
    return entry;
}

/// Computes each cell's Chebyshev distance to the nearest non-empty cell of the grid, one axis after the other.
void measure_distances(PageTree& tree)
{
    constexpr uint32_t LIMIT = gpu::LEAP_LIMIT;
    const glm::uvec3 counts = tree.counts;
    const size_t cells = size_t(counts.x) * counts.y * counts.z;
    std::vector<uint8_t> distance(cells), before;
    for (size_t cell = 0; cell < cells; ++cell)
        distance[cell] = tree.entries[cell] >> gpu::PAGE_DISTANCE_SHIFT != 0 ? uint8_t(LIMIT) : uint8_t(0);
    const std::array<size_t, 3> strides{1, counts.x, size_t(counts.x) * counts.y};
    for (int axis = 0; axis < 3; ++axis) {
        before = distance;
        for (size_t cell = 0; cell < cells; ++cell) {
            const size_t at = cell / strides[size_t(axis)] % counts[axis];
            uint8_t best = before[cell];
            for (size_t k = 1; k < best; ++k) {
                const auto reach = [&](size_t other) { return std::max(uint8_t(k), before[other]); };
                if (k <= at) best = std::min(best, reach(cell - k * strides[size_t(axis)]));
                if (at + k < counts[axis]) best = std::min(best, reach(cell + k * strides[size_t(axis)]));
            }
            distance[cell] = best;
        }
    }
    for (size_t cell = 0; cell < cells; ++cell)
        if (distance[cell] > 0) tree.entries[cell] = empty_entry(distance[cell]);
}

}  // namespace

PageTree make_page_tree(const VolumeInfo& volume, int levels, const PageView& view,
                        const std::function<bool(const BrickKey&)>& shows, size_t max_leaves)
{
    SHVR_CHECK(levels >= 1 && levels < int(gpu::PAGE_NODE), levels);
    Cutter cutter(volume, levels, view, shows, max_leaves);
    double detail = view.detail;
    while (!cutter.cut(detail)) detail = detail > 0.0 ? 0.5 * detail : 1.0;

    PageTree tree;
    tree.leaves = std::move(cutter.leaves());
    std::ranges::stable_sort(tree.leaves, {}, &PageTree::Leaf::depth);
    tree.finest_level = levels - 1;
    for (const PageTree::Leaf& leaf : tree.leaves) tree.finest_level = std::min(tree.finest_level, leaf.key.level);

    // The grid's cells are at least as large as the finest leaf, and few enough to be rebuilt quickly.
    tree.cell_shift = tree.finest_level + 5;
    const int64_t longest = std::max({volume.size.x, volume.size.y, volume.size.z});
    while ((longest - 1) >> tree.cell_shift >= int64_t{gpu::PAGE_GRID}) ++tree.cell_shift;
    tree.depth = tree.cell_shift - (tree.finest_level + 5);
    tree.counts = glm::uvec3(((volume.size - int64_t{1}) >> int64_t{tree.cell_shift}) + int64_t{1});
    tree.entries.assign(size_t(tree.counts.x) * tree.counts.y * tree.counts.z, empty_entry(1));

    tree.entries_of_leaves.reserve(tree.leaves.size());
    tree.begin_of_leaf.reserve(tree.leaves.size() + 1);
    for (const PageTree::Leaf& leaf : tree.leaves) {
        const BrickKey& key = leaf.key;
        tree.begin_of_leaf.push_back(uint32_t(tree.entries_of_leaves.size()));
        const int coarser = key.level + 5 - tree.cell_shift;  // log2 of the leaf's side, in cells of the grid
        const glm::ivec3 first = coarser > 0 ? key.brick << coarser : key.brick >> -coarser;
        const glm::ivec3 end = glm::min(coarser > 0 ? (key.brick + 1) << coarser : first + 1, glm::ivec3(tree.counts));
        for (int z = first.z; z < end.z; ++z)
            for (int y = first.y; y < end.y; ++y)
                for (int x = first.x; x < end.x; ++x) {
                    const uint32_t cell = gpu::grid_index(glm::uvec3(x, y, z), tree.counts);
                    const uint32_t entry = entry_below(tree, cell, tree.cell_shift, key);
                    tree.entries[entry] = 0;
                    tree.entries_of_leaves.push_back(entry);
                }
    }
    tree.begin_of_leaf.push_back(uint32_t(tree.entries_of_leaves.size()));
    tree.leaf_of_entry.assign(tree.entries.size(), PageTree::NO_LEAF);
    for (uint32_t leaf = 0; leaf < tree.leaves.size(); ++leaf)
        for (uint32_t i = tree.begin_of_leaf[leaf]; i < tree.begin_of_leaf[leaf + 1]; ++i)
            tree.leaf_of_entry[tree.entries_of_leaves[i]] = leaf;
    measure_distances(tree);
    return tree;
}

void for_each_entry_below(const PageTree& tree, const BrickKey& key,
                          const std::function<void(uint32_t entry, uint32_t leaf)>& visit)
{
    const auto descend = [&](const auto& self, uint32_t entry) -> void {
        if (tree.entries[entry] >> gpu::PAGE_LEVEL_SHIFT == gpu::PAGE_NODE) {
            for (uint32_t child = 0; child < 8; ++child)
                self(self, (tree.entries[entry] & gpu::PAGE_PAYLOAD_MASK) + child);
        } else if (const uint32_t leaf = tree.leaf_of_entry[entry]; leaf != PageTree::NO_LEAF) {
            if (tree.leaves[leaf].key.level <= key.level) visit(entry, leaf);
        }
    };
    const int coarser = key.level + 5 - tree.cell_shift;  // log2 of the brick's side, in cells of the grid
    if (coarser < 0) {
        uint32_t entry = gpu::grid_index(glm::uvec3(key.brick >> -coarser), tree.counts);
        for (int shift = -coarser - 1; shift >= 0; --shift) {
            if (tree.entries[entry] >> gpu::PAGE_LEVEL_SHIFT != gpu::PAGE_NODE) return;  // the brick lies within a leaf
            const glm::ivec3 half = key.brick >> shift & 1;
            entry = (tree.entries[entry] & gpu::PAGE_PAYLOAD_MASK) + uint32_t(half.x + 2 * half.y + 4 * half.z);
        }
        return descend(descend, entry);
    }
    const glm::ivec3 first = key.brick << coarser, end = glm::min((key.brick + 1) << coarser, glm::ivec3(tree.counts));
    for (int z = first.z; z < end.z; ++z)
        for (int y = first.y; y < end.y; ++y)
            for (int x = first.x; x < end.x; ++x) descend(descend, gpu::grid_index(glm::uvec3(x, y, z), tree.counts));
}

}  // namespace shvr

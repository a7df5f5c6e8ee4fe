#include "tests/reference/components.h"

#include <algorithm>
#include <cstdlib>

namespace shvr::reference {

namespace {

std::vector<Size3> neighbour_steps(int connectivity)
{
    std::vector<Size3> steps;
    for (int64_t z = -1; z <= 1; ++z)
        for (int64_t y = -1; y <= 1; ++y)
            for (int64_t x = -1; x <= 1; ++x) {
                const int64_t axes = std::abs(x) + std::abs(y) + std::abs(z);
                if (axes == 1 || (connectivity == 26 && axes > 0)) steps.emplace_back(x, y, z);
            }
    return steps;
}

bool is_in_region(const BrushRegion& region, const Size3& voxel)
{
    for (int axis = 0; axis < 3; ++axis)
        if (voxel[axis] < region.box.lower[axis] || voxel[axis] >= region.box.upper[axis]) return false;
    const Size3 at = voxel - region.box.lower;
    const gpu::RowSpan span = region.rows[size_t(at.y + region.box.size().y * at.z)];
    return at.x >= span.begin && at.x < span.end;
}

bool is_edge(const BrushRegion& region, const Size3& voxel)
{
    const std::vector<Size3> steps = neighbour_steps(6);
    return std::any_of(steps.begin(), steps.end(),
                       [&](const Size3& step) { return !is_in_region(region, voxel + step); });
}

/// A set of voxels of the region, as words.
class Words {
public:
    explicit Words(const BrushRegion& region)
        : box_(region.box),
          per_row_((region.box.size().x + 31) / 32),
          words_(size_t(per_row_ * region.box.size().y * region.box.size().z))
    {}

    bool has(const Size3& voxel) const { return (words_[word_of(voxel)] >> bit_of(voxel) & 1u) != 0; }
    void add(const Size3& voxel) { words_[word_of(voxel)] |= 1u << bit_of(voxel); }
    const std::vector<uint32_t>& words() const { return words_; }

private:
    size_t word_of(const Size3& voxel) const
    {
        const Size3 at = voxel - box_.lower;
        return size_t(at.x / 32 + per_row_ * (at.y + box_.size().y * at.z));
    }
    uint32_t bit_of(const Size3& voxel) const { return uint32_t((voxel.x - box_.lower.x) % 32); }

    VoxelBox box_;
    int64_t per_row_;
    std::vector<uint32_t> words_;
};

Words open_voxels(const BrushRegion& region, const OpenVoxel& open)
{
    Words found(region);
    const VoxelBox& box = region.box;
    for (int64_t z = box.lower.z; z < box.upper.z; ++z)
        for (int64_t y = box.lower.y; y < box.upper.y; ++y)
            for (int64_t x = box.lower.x; x < box.upper.x; ++x)
                if (is_in_region(region, {x, y, z}) && open({x, y, z})) found.add({x, y, z});
    return found;
}

/// The voxels connected to `seed`, which is open, breadth first; adds them to `seen`.
std::vector<Size3> component_of(const BrushRegion& region, const Words& open, const Size3& seed, int connectivity,
                                Words& seen)
{
    const std::vector<Size3> steps = neighbour_steps(connectivity);
    std::vector<Size3> component{seed};
    seen.add(seed);
    for (size_t next = 0; next < component.size(); ++next)
        for (const Size3& step : steps) {
            const Size3 neighbour = component[next] + step;
            if (!is_in_region(region, neighbour) || !open.has(neighbour) || seen.has(neighbour)) continue;
            seen.add(neighbour);
            component.push_back(neighbour);
        }
    return component;
}

}  // namespace

std::vector<uint32_t> fill_words(const BrushRegion& region, const OpenVoxel& open)
{
    return open_voxels(region, open).words();
}

std::vector<uint32_t> flood_words(const BrushRegion& region, const OpenVoxel& open, Size3 seed, int connectivity)
{
    const Words opened = open_voxels(region, open);
    Words flooded(region);
    if (is_in_region(region, seed) && opened.has(seed)) component_of(region, opened, seed, connectivity, flooded);
    return flooded.words();
}

std::vector<uint32_t> speckle_words(const BrushRegion& region, const OpenVoxel& open, int connectivity)
{
    const Words opened = open_voxels(region, open);
    Words seen(region), selected(region);
    const VoxelBox& box = region.box;
    for (int64_t z = box.lower.z; z < box.upper.z; ++z)
        for (int64_t y = box.lower.y; y < box.upper.y; ++y)
            for (int64_t x = box.lower.x; x < box.upper.x; ++x) {
                const Size3 start(x, y, z);
                if (!opened.has(start) || seen.has(start)) continue;
                const std::vector<Size3> component = component_of(region, opened, start, connectivity, seen);
                if (std::any_of(component.begin(), component.end(),
                                [&](const Size3& voxel) { return is_edge(region, voxel); }))
                    continue;
                for (const Size3& voxel : component) selected.add(voxel);
            }
    return selected.words();
}

std::vector<uint32_t> component_labels(const Size3& size, const OpenVoxel& open, int connectivity)
{
    const std::vector<Size3> steps = neighbour_steps(connectivity);
    const auto index = [&](const Size3& at) { return size_t(at.x + size.x * (at.y + size.y * at.z)); };
    std::vector<uint32_t> labels(size_t(size.x * size.y * size.z));
    uint32_t components = 0;
    for (int64_t z = 0; z < size.z; ++z)
        for (int64_t y = 0; y < size.y; ++y)
            for (int64_t x = 0; x < size.x; ++x) {
                if (labels[index({x, y, z})] != 0 || !open({x, y, z})) continue;
                std::vector<Size3> queue{{x, y, z}};
                labels[index(queue[0])] = ++components;
                for (size_t i = 0; i < queue.size(); ++i)
                    for (const Size3& step : steps) {
                        const Size3 next = queue[i] + step;
                        const bool is_inside =
                            glm::all(glm::greaterThanEqual(next, Size3(0))) && glm::all(glm::lessThan(next, size));
                        if (!is_inside || labels[index(next)] != 0 || !open(next)) continue;
                        labels[index(next)] = components;
                        queue.push_back(next);
                    }
            }
    return labels;
}

}  // namespace shvr::reference

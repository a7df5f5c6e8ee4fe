#include "engine/annotation/density_brush.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/base/error.h"
#include "engine/volume/grid.h"

namespace shvr {

double automatic_offset(double lowest_point, double paint_threshold)
{
    return std::max(0.0, lowest_point - paint_threshold);
}

uint32_t painted_offset(VoxelType type, uint32_t old, uint32_t most, uint32_t here)
{
    const double was = offset_of(type, old), high = offset_of(type, most), p = offset_of(type, here);
    const bool raises = high >= 0.0;
    const bool is_beyond = raises ? was > high : was < high;
    const double kept = is_beyond ? high : was;
    const bool p_wins = raises ? p > kept : p < kept;
    return p_wins ? here : is_beyond ? most : old;
}

DensityStroke::DensityStroke(Size3 size, const glm::dvec3& spacing, VoxelType type, double offset, Falloff falloff)
    : size_(size),
      counts_(brick_grid(size)),
      spacing_(spacing),
      type_(type),
      offset_(offset),
      falloff_(falloff),
      selection_(size)
{
    if (!std::isfinite(offset)) fail("density offset is ", offset, "; expected a finite number");
}

void DensityStroke::add(const BrushRegion& region, std::span<const uint32_t> words, const glm::dvec3& centre_voxel,
                        double radius_voxels)
{
    selection_.add(region, words);
    if (falloff_ == Falloff::flat) return;
    const double radius = radius_voxels * spacing_.x;
    const Size3 extent = region.box.size();
    for (int64_t z = 0; z < extent.z; ++z)
        for (int64_t y = 0; y < extent.y; ++y) {
            const size_t row = size_t(y + extent.y * z);
            for (int64_t w = 0; w < region.words_per_row(); ++w)
                for (uint32_t left = words[row * size_t(region.words_per_row()) + size_t(w)]; left != 0;
                     left &= left - 1) {
                    const int64_t x = 32 * w + std::countr_zero(left);
                    if (x < region.rows[row].begin || x >= region.rows[row].end) continue;
                    const Size3 voxel = region.box.lower + Size3(x, y, z);
                    const double distance = glm::length((glm::dvec3(voxel) + 0.5 - centre_voxel) * spacing_);
                    const uint32_t here = offset_bits(type_, offset_ * std::max(0.0, 1.0 - distance / radius));
                    if (here == 0) continue;
                    std::unique_ptr<OffsetBrick>& brick = strongest_[index_of(voxel / BRICK_SIDE, counts_)];
                    if (!brick) brick = std::make_unique<OffsetBrick>(OffsetBrick{});
                    uint32_t& strongest = (*brick)[index_in_brick(voxel)];
                    if (std::abs(offset_of(type_, here)) > std::abs(offset_of(type_, strongest))) strongest = here;
                }
        }
}

std::vector<DensityBrickChange> DensityStroke::changes(const DensityField& field) const
{
    SHVR_CHECK(field.size() == size_ && field.type() == type_, "the offsets are of another volume");
    const uint32_t most = offset_bits(type_, offset_);
    std::vector<DensityBrickChange> changes;
    for (const auto& [index, bits] : selection_.bricks()) {
        const std::shared_ptr<const OffsetBrick> before = field.brick(index);
        const auto strongest = strongest_.find(index);
        DensityBrickChange change{.brick = index, .runs = {}};
        for (size_t row = 0; row < bits.size(); ++row)
            for (uint32_t left = bits[row]; left != 0; left &= left - 1) {
                const size_t at = 32 * row + size_t(std::countr_zero(left));
                const uint32_t here = falloff_ == Falloff::flat       ? most
                                      : strongest == strongest_.end() ? 0
                                                                      : (*strongest->second)[at];
                const uint32_t old = before ? (*before)[at] : 0;
                append_run(change.runs, at, at, old, painted_offset(type_, old, most, here));
            }
        if (change.runs.empty()) continue;
        change.runs.shrink_to_fit();  // the history keeps it
        changes.push_back(std::move(change));
    }
    return changes;
}

}  // namespace shvr

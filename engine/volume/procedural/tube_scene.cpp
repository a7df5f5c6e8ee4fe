#include "engine/volume/procedural/tube_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace shvr {

TubeDistance distance_from(const Tube& tube, const glm::dvec3& voxel)
{
    const glm::dvec3 d = voxel - tube.ends[0];
    const glm::dvec3 axis = tube.ends[1] - tube.ends[0];
    const double squared = axis.x * axis.x + axis.y * axis.y + axis.z * axis.z;
    const double from_first = d.x * d.x + d.y * d.y + d.z * d.z;
    const auto [r0, r1] = tube.radii;
    const double length = std::sqrt(squared);
    if (length <= std::abs(r0 - r1)) {  // one end's ball contains the other, and is the whole tube
        if (r0 >= r1) return {std::sqrt(from_first) - r0, 0.0};
        const glm::dvec3 e = voxel - tube.ends[1];
        return {std::sqrt(e.x * e.x + e.y * e.y + e.z * e.z) - r1, 1.0};
    }
    // Position in the half-plane that is bounded by the axis: y along the axis, x the distance from it.
    const double y = (d.x * axis.x + d.y * axis.y + d.z * axis.z) / length;
    const double x = std::sqrt(std::max(0.0, from_first - y * y));
    const double slope = (r0 - r1) / length;  // sine of the angle between axis and surface
    const double flat = std::sqrt(1.0 - slope * slope);
    const double along = flat * y - slope * x;  // position along the surface, from where it leaves the first ball
    if (along < 0.0) return {std::sqrt(from_first) - r0, 0.0};
    if (along > flat * length) {
        const double past = y - length;
        return {std::sqrt(x * x + past * past) - r1, 1.0};
    }
    return {flat * x + slope * y - r0, along / (flat * length)};
}

TubeScene::TubeScene(std::vector<Tube> tubes, const Size3& size, double reach)
    : tubes_(std::move(tubes)),
      cell_(glm::max(glm::dvec3(4.0), glm::dvec3(size) / 64.0)),
      counts_(glm::max(Size3(1), Size3(glm::ceil(glm::dvec3(size) / cell_)))),
      first_(size_t(counts_.x * counts_.y * counts_.z) + 1)
{
    const auto each_cell = [&](const Tube& tube, const auto& visit) {
        const auto [lower, upper] = cells_of(tube, reach);
        for (int64_t z = lower.z; z <= upper.z; ++z)
            for (int64_t y = lower.y; y <= upper.y; ++y)
                for (int64_t x = lower.x; x <= upper.x; ++x) {
                    // Tests each cell's distance, since a diagonal tube is far from most cells of its bounding box.
                    const glm::dvec3 middle = (glm::dvec3(x, y, z) + 0.5) * cell_;
                    const double diagonal = 0.5 * std::sqrt(cell_.x * cell_.x + cell_.y * cell_.y + cell_.z * cell_.z);
                    const bool is_border = glm::any(glm::equal(Size3(x, y, z), Size3(0))) ||
                                           glm::any(glm::equal(Size3(x, y, z), counts_ - Size3(1)));
                    if (is_border || distance_from(tube, middle).voxels <= diagonal + reach + 1e-6)
                        visit(size_t(x + counts_.x * (y + counts_.y * z)));
                }
    };
    for (const Tube& tube : tubes_) each_cell(tube, [&](size_t cell) { ++first_[cell + 1]; });
    for (size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    lists_.resize(first_.back());
    std::vector<uint32_t> next(first_.begin(), first_.end() - 1);
    for (uint32_t i = 0; i < tubes_.size(); ++i) each_cell(tubes_[i], [&](size_t cell) { lists_[next[cell]++] = i; });
}

TubeScene::CellRange TubeScene::cells_of(const Tube& tube, double reach) const
{
    const double around = std::max(tube.radii[0], tube.radii[1]) + reach + 1e-6;
    const glm::dvec3 last(counts_ - Size3(1));
    const auto cell = [&](const glm::dvec3& p) { return Size3(glm::clamp(glm::floor(p / cell_), 0.0, 1e9)); };
    return {glm::min(cell(glm::min(tube.ends[0], tube.ends[1]) - around), Size3(last)),
            glm::min(cell(glm::max(tube.ends[0], tube.ends[1]) + around), Size3(last))};
}

std::span<const uint32_t> TubeScene::near(const glm::dvec3& voxel) const
{
    const Size3 at(glm::clamp(glm::floor(voxel / cell_), glm::dvec3(0.0), glm::dvec3(counts_ - Size3(1))));
    const auto cell = size_t(at.x + counts_.x * (at.y + counts_.y * at.z));
    return std::span(lists_).subspan(first_[cell], first_[cell + 1] - first_[cell]);
}

uint8_t TubeScene::group(const glm::dvec3& voxel) const
{
    uint8_t group = 0;
    double deepest = 1e-6;
    for (const uint32_t i : near(voxel)) {
        if (tubes_[i].group == 0) continue;
        const double distance = distance_from(tubes_[i], voxel).voxels;
        if (distance > deepest || (group != 0 && distance == deepest)) continue;
        deepest = distance;
        group = tubes_[i].group;
    }
    return group;
}

}  // namespace shvr

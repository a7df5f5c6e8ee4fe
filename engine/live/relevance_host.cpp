#include "engine/live/relevance_host.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/volume/voxel_numbers.h"

namespace shvr {

VoxelBox relevance_cube(const glm::dvec3& voxel, const Size3& volume_size, int64_t side)
{
    for (int axis = 0; axis < 3; ++axis)
        if (!std::isfinite(voxel[axis])) fail("the probe's place along ", "xyz"[axis], " is ", voxel[axis]);
    const Size3 size = glm::min(volume_size, Size3(side));
    const glm::dvec3 lower =
        glm::clamp(glm::round(voxel - 0.5 * glm::dvec3(size)), glm::dvec3(0.0), glm::dvec3(volume_size - size));
    return {Size3(lower), Size3(lower) + size};
}

bool RelevancePlace::covers(const glm::dvec3& centre, double radius) const
{
    const glm::dvec3 lower = (centre - radius) / spacing, upper = (centre + radius) / spacing;
    for (int axis = 0; axis < 3; ++axis) {
        if (!std::isfinite(lower[axis]) || !std::isfinite(upper[axis])) return false;
        // A ball entirely outside the volume along an axis contains no voxels, so no bits are needed for it.
        if (upper[axis] <= 0.0 || lower[axis] >= double(level_size[axis])) return true;
    }
    const glm::dvec3 least = glm::max(lower, glm::dvec3(0.0)), most = glm::min(upper, glm::dvec3(level_size));
    return glm::all(glm::greaterThanEqual(least, glm::dvec3(box.lower))) &&
           glm::all(glm::lessThanEqual(most, glm::dvec3(box.upper)));
}

namespace {

constexpr double ROUNDING = 1.0;  ///< in voxels; a cube's corner is rounded to a whole voxel

/// Returns the cube's side, in voxels, for a ball that moves by `travel` before the cube arrives.
int64_t side_for(double radius, double travel)
{
    constexpr double SMALL = 24.0;
    if (radius > SMALL) return Relevance::LARGE_SIDE;
    for (const int64_t side : {Relevance::SIDE, Relevance::MOVING_SIDE})
        if (radius + travel + ROUNDING <= 0.5 * double(side)) return side;
    return Relevance::LARGE_SIDE;
}

}  // namespace

RelevancePlace relevance_place(const VolumeSource& source, const RegionWish& wish)
{
    const VolumeInfo& info = source.info();
    const double finest = std::min({info.spacing.x, info.spacing.y, info.spacing.z});
    RelevancePlace place;
    const double travel = glm::length(wish.travel());
    const auto is_too_fine = [&](double voxel) {
        const bool leaves = (wish.radius + travel) / voxel + ROUNDING > 0.5 * double(Relevance::LARGE_SIDE);
        return wish.radius / voxel > RelevancePlace::MAX_BALL_RADIUS ||
               (leaves && wish.radius / (2.0 * voxel) >= RelevancePlace::MIN_COARSE_RADIUS);
    };
    while (place.level + 1 < source.levels() && is_too_fine(std::ldexp(finest, place.level))) ++place.level;
    place.spacing = info.spacing * std::ldexp(1.0, place.level);
    place.level_size = size_of_level(info.size, place.level);
    const double voxel = std::ldexp(finest, place.level);
    const int64_t side = side_for(wish.radius / voxel, travel / voxel);
    const glm::dvec3 middle = wish.region_middle(0.5 * double(side) * place.spacing);
    place.box = relevance_cube(middle / place.spacing, place.level_size, side);
    return place;
}

namespace {

/// Returns whether at least half of a box's painted voxels, and at least one, can be felt. Unpainted voxels count only
/// if group 0 can be felt.
bool is_mostly_felt(const Mask& mask, const std::bitset<256>& groups, const VoxelBox& box)
{
    int64_t felt = 0, others = 0;
    const Size3 first = box.lower / int64_t{BRICK_SIDE}, last = (box.upper - int64_t{1}) / int64_t{BRICK_SIDE};
    const Size3 bricks = last - first + int64_t{1};
    for (int64_t i = 0; i < bricks.x * bricks.y * bricks.z; ++i) {
        const int64_t index = index_of(first + position_of(i, bricks), mask.brick_counts());
        const VoxelBox of_brick = mask.box_of(index);
        const VoxelBox part{glm::max(box.lower, of_brick.lower), glm::min(box.upper, of_brick.upper)};
        const std::shared_ptr<const MaskBrick>& brick = mask.brick(index);
        if (!brick) {  // unpainted
            const Size3 size = part.size();
            felt += groups[0] ? size.x * size.y * size.z : 0;
            continue;
        }
        for (int64_t z = part.lower.z; z < part.upper.z; ++z)
            for (int64_t y = part.lower.y; y < part.upper.y; ++y)
                for (int64_t x = part.lower.x; x < part.upper.x; ++x) {
                    const uint8_t group = (*brick)[index_in_brick({x, y, z})];
                    felt += groups[group];
                    others += !groups[group] && group != 0;
                }
    }
    return felt > 0 && felt >= others;
}

}  // namespace

void limit_to_groups(const Mask& mask, const std::bitset<256>& groups, RelevanceBits& bits)
{
    const Size3 size = bits.box.size();
    const int64_t step = int64_t{1} << bits.level;
    const auto is_felt = [&](const Size3& voxel) {
        const Size3 lower = voxel * step, upper = glm::min(lower + step, mask.size());
        if (step == 1) return groups[mask.at(glm::min(lower, mask.size() - int64_t{1}))];
        return is_mostly_felt(mask, groups, {lower, upper});
    };
    for (int64_t z = 0; z < size.z; ++z)
        for (int64_t y = 0; y < size.y; ++y)
            for (int64_t w = 0; w < bits.words_per_row; ++w) {
                uint32_t& word = bits.words[size_t(w + bits.words_per_row * (y + size.y * z))];
                for (uint32_t left = word; left != 0; left &= left - 1) {
                    const int bit = std::countr_zero(left);
                    if (!is_felt(bits.box.lower + Size3(32 * w + bit, y, z))) word &= ~(1u << bit);
                }
            }
}

namespace {

VoxelBox covered_by(const Size3& voxel, int level, const Size3& volume_size)
{
    const int64_t step = int64_t{1} << level;
    return {voxel * step, glm::min(voxel * step + step, volume_size)};
}

bool is_mostly_painted(const Mask& mask, const VoxelBox& box)
{
    int64_t painted = 0, voxels = 0;
    for (int64_t z = box.lower.z; z < box.upper.z; ++z)
        for (int64_t y = box.lower.y; y < box.upper.y; ++y)
            for (int64_t x = box.lower.x; x < box.upper.x; ++x, ++voxels) painted += mask.at({x, y, z}) != 0;
    return painted > 0 && 2 * painted >= voxels;
}

/// Calls `visit(voxel in the box, intensity)` for each voxel at or above the threshold. Sets the voxel's bit if `visit`
/// returns true.
template <class Visit>
RelevanceBits bits_where(const VolumeSource& source, int level, const VoxelBox& box, double threshold,
                         const Visit& visit)
{
    const Size3 size = box.size();
    std::vector<double> values(size_t(size.x * size.y * size.z));
    std::vector<std::byte> bytes(values.size() * bytes_of(source.info().type));
    source.read_level(level, box, bytes);
    load_voxels(source.info().type, bytes.data(), values);
    RelevanceBits bits{.box = box, .words_per_row = (size.x + 31) / 32, .words = {}, .level = level};
    bits.words.assign(size_t(bits.words_per_row * size.y * size.z), 0u);
    for (int64_t row = 0; row < size.y * size.z; ++row)
        for (int64_t x = 0; x < size.x; ++x) {
            const double value = values[size_t(row * size.x + x)];
            if (value >= threshold && visit(Size3(x, row % size.y, row / size.y), value))
                bits.words[size_t(row * bits.words_per_row + x / 32)] |= 1u << (x % 32);
        }
    return bits;
}

}  // namespace

RelevanceBits relevance_on_host(const VolumeSource& source, int level, const VoxelBox& box, double threshold)
{
    return bits_where(source, level, box, threshold, [](const Size3&, double) { return true; });
}

RelevanceBits relevance_on_host(const VolumeSource& source, int level, const VoxelBox& box, double threshold,
                                const FeltLimits& limits, const Mask* mask)
{
    if (!limits.unpainted) return relevance_on_host(source, level, box, threshold);
    return bits_where(source, level, box, threshold, [&](const Size3& at, double value) {
        return contains(*limits.unpainted, value) ||
               (mask && is_mostly_painted(*mask, covered_by(box.lower + at, level, mask->size())));
    });
}

}  // namespace shvr

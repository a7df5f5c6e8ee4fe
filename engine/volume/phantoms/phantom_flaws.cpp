#include "engine/volume/phantoms/phantom_flaws.h"

#include <algorithm>
#include <cmath>

#include "engine/volume/phantoms/phantom_model.h"
#include "engine/volume/phantoms/texture.h"
#include "engine/volume/procedural/procedural_hash.h"
#include "engine/volume/procedural/turns.h"

namespace shvr {

namespace {

enum FlawRandom : uint32_t { NOISE = 11, SPECKS, RINGS, STREAKS, UNEVEN };
constexpr double CONTRAST = VEIN - GROUND_TISSUE;
constexpr uint32_t STREAK_COUNT = 12;

uint32_t hash_at(uint32_t seed, FlawRandom purpose, const Size3& at)
{
    return hash_of(mixed(seed) ^ purpose, uint32_t(at.x), uint32_t(at.y), uint32_t(at.z));
}

/// Returns approximately normal noise with standard deviation 1: the scaled sum of the hash's four bytes.
double normal_of(uint32_t hash)
{
    constexpr double DEVIATION = 147.8016689;
    const uint32_t sum = (hash & 0xffu) + (hash >> 8 & 0xffu) + (hash >> 16 & 0xffu) + (hash >> 24);
    return (double(sum) - 510.0) / DEVIATION;
}

}  // namespace

double random_unit(uint32_t seed, uint32_t purpose, uint32_t index, uint32_t of)
{
    return unit_of(hash_of(seed ^ 0x9a7b3c51u, index, of, purpose));
}

FlawedIntensity::FlawedIntensity(const PhantomFlaws& flaws, const Size3& size, uint32_t seed)
    : flaws_(flaws), centre_(0.5 * glm::dvec3(size)), radius_(0.5 * double(std::min(size.x, size.y))), seed_(seed)
{
    if (flaws_.streaks == 0.0) return;
    for (uint32_t i = 0; i < STREAK_COUNT; ++i) {
        const auto random = [&](uint32_t of) { return random_unit(seed, STREAKS, i, of); };
        streaks_.push_back({glm::dvec3(random(0), random(1), random(2)) * glm::dvec3(size), direction_of(random(3))});
    }
}

/// Adds bright balls. Each cell of 8^3 voxels has at most one.
double FlawedIntensity::with_specks(double intensity, const glm::dvec3& voxel) const
{
    constexpr double CELL = 8.0, MEAN_BALL = 25.7;  // MEAN_BALL: voxels of a ball, as a mean over all radii
    const Size3 cell(glm::floor(voxel / CELL));
    uint32_t hash = hash_at(seed_, SPECKS, cell);
    if (unit_of(hash) * MEAN_BALL * 100.0 >= flaws_.specks * CELL * CELL * CELL) return intensity;
    const auto next = [&hash] { return unit_of(hash = mixed(hash + 1)); };
    const double radius = 0.94 + 1.56 * next();
    double squared = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        const double centre = CELL * double(cell[axis]) + radius + (CELL - 2.0 * radius) * next();
        squared += (voxel[axis] - centre) * (voxel[axis] - centre);
    }
    return std::max(intensity, GROUND_TISSUE + CONTRAST * cover_of(std::sqrt(squared) - radius, flaws_.blur));
}

/// Returns the height of the rings at a voxel. Two thirds of the rings have height 0; a ring spans four slices.
double FlawedIntensity::rings(const glm::dvec3& voxel) const
{
    const double dx = voxel.x - centre_.x, dy = voxel.y - centre_.y;
    const double place = std::sqrt(dx * dx + dy * dy);
    const double ring = std::floor(place), share = place - ring;
    const auto height = [&](double index) {
        const uint32_t hash = hash_at(seed_, RINGS, {int64_t(index), int64_t(voxel.z) / 4, 0});
        return hash % 3 == 0 ? 2.0 * unit_of(mixed(hash)) - 1.0 : 0.0;
    };
    return height(ring) * (1.0 - share) + height(ring + 1.0) * share;
}

/// Returns the streaks at a voxel: planes along z, three voxels thick, which fade within 1/8 of the volume's radius.
double FlawedIntensity::streaks(const glm::dvec3& voxel) const
{
    double sum = 0.0, sign = 1.0;
    for (const Streak& streak : streaks_) {
        const glm::dvec3 d = voxel - streak.through;
        const double across = std::abs(d.x * streak.across.x + d.y * streak.across.y);
        const double slices = std::abs(d.z) * 8.0 / radius_;
        sum += sign * std::max(0.0, 1.0 - across / 1.5) * std::max(0.0, 1.0 - slices);
        sign = -sign;
    }
    return sum;
}

double FlawedIntensity::operator()(double intensity, const glm::dvec3& voxel) const
{
    if (flaws_.specks > 0.0) intensity = with_specks(intensity, voxel);
    if (flaws_.falling > 0.0) {
        const double dx = (voxel.x - centre_.x) / radius_, dy = (voxel.y - centre_.y) / radius_;
        intensity *= 1.0 - 0.01 * flaws_.falling * std::max(0.0, 1.0 - dx * dx - dy * dy);
    }
    if (flaws_.uneven > 0.0) {
        const double varied = value_noise(mixed(seed_) ^ UNEVEN, (voxel - centre_) / (0.5 * radius_));
        intensity *= 1.0 + 0.01 * flaws_.uneven * (2.0 * varied - 1.0);
    }
    double added = 0.0;
    if (flaws_.rings > 0.0) added += flaws_.rings * rings(voxel);
    if (flaws_.streaks > 0.0) added += flaws_.streaks * streaks(voxel);
    if (flaws_.noise > 0.0) added += flaws_.noise * normal_of(hash_at(seed_, NOISE, Size3(glm::floor(voxel))));
    return std::clamp(intensity + 0.01 * CONTRAST * added, 0.0, 250.0);
}

}  // namespace shvr

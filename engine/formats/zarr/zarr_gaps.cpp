#include "engine/formats/zarr/zarr_gaps.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/volume/voxel_numbers.h"

namespace shvr {
namespace {

/// One byte each; larger volumes are not checked.
constexpr int64_t MAX_CHUNKS = int64_t{1} << 24;

}  // namespace

ZarrGaps::ZarrGaps(const std::vector<ZarrVolume>& levels) : levels_(levels)
{
    for (const ZarrVolume& level : levels) {
        const Size3 counts = level.counts();
        int64_t chunks = counts.x;
        const bool is_too_much = __builtin_mul_overflow(chunks, counts.y, &chunks) ||
                                 __builtin_mul_overflow(chunks, counts.z, &chunks) || chunks > MAX_CHUNKS;
        found_.push_back(is_too_much ? nullptr : std::make_unique<std::atomic<Found>[]>(size_t(chunks)));
    }
}

std::optional<ValueRange> ZarrGaps::range(int level, const VoxelBox& box) const
{
    int64_t files = 0;
    for (int below = level; below >= 0; --below) {
        if (!found_[size_t(below)]) return std::nullopt;
        files += chunks_below(level, box, below).count();
        if (files > MAX_FILES) return std::nullopt;
    }
    ValueRange range{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
    for (int below = level; below >= 0; --below) {
        if (!are_missing(below, chunks_below(level, box, below))) return std::nullopt;
        const ZarrVolume& volume = levels_[size_t(below)];
        // An array that was removed must not look empty.
        if (!volume.is_there()) return std::nullopt;
        double fill = 0.0;
        load_voxels(volume.metadata().type, volume.metadata().fill.data(), std::span(&fill, 1));
        if (!std::isfinite(fill)) continue;
        range.lower = std::min(range.lower, fill);
        range.upper = std::max(range.upper, fill);
    }
    return range;
}

ZarrGaps::Chunks ZarrGaps::chunks_below(int level, const VoxelBox& box, int below) const
{
    const ZarrVolume& volume = levels_[size_t(below)];
    const int64_t factor = int64_t{1} << (level - below);
    // A level whose size was rounded down lacks its last voxels; the last existing ones stand for them.
    const Size3 lower = glm::min(box.lower * factor, volume.size() - int64_t{1});
    const Size3 upper = glm::min(box.upper * factor, volume.size());
    return {lower / volume.chunk(), (upper - int64_t{1}) / volume.chunk() + int64_t{1}};
}

bool ZarrGaps::are_missing(int level, const Chunks& chunks) const
{
    Size3 at;
    for (at.z = chunks.begin.z; at.z < chunks.end.z; ++at.z) {
        for (at.y = chunks.begin.y; at.y < chunks.end.y; ++at.y) {
            for (at.x = chunks.begin.x; at.x < chunks.end.x; ++at.x) {
                if (!is_missing(level, at)) return false;
            }
        }
    }
    return true;
}

bool ZarrGaps::is_missing(int level, const Size3& chunk) const
{
    const ZarrVolume& volume = levels_[size_t(level)];
    std::atomic<Found>& found = found_[size_t(level)][size_t(volume.index_of(chunk))];
    // Two threads that look at the same time find the same.
    if (found.load(std::memory_order_relaxed) == Found::unknown) {
        found.store(volume.is_missing(chunk) ? Found::missing : Found::stored, std::memory_order_relaxed);
    }
    return found.load(std::memory_order_relaxed) == Found::missing;
}

}  // namespace shvr

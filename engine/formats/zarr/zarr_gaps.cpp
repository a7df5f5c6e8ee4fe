#include "engine/formats/zarr/zarr_gaps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>

#include "engine/base/error.h"
#include "engine/volume/voxel_numbers.h"

namespace shvr {
namespace {

/// Up to this many chunks, enough for most bricks with their apron, are probed one by one, since listing is slower.
constexpr int64_t FEW_FILES = 8;
constexpr size_t MANY_LOOKS = 4096;
/// Bits of a chunk's number along one axis; numbers are below 2^21.
constexpr int CODE_BITS = 21;

/// Returns `number` with bit i moved to bit 3 i.
uint64_t spread(uint64_t number)
{
    uint64_t code = 0;
    for (int bit = 0; bit < CODE_BITS; ++bit) code |= (number >> bit & 1) << 3 * bit;
    return code;
}

/// Returns the chunk's Morton code. In an aligned cube of 2^k chunks per side, all codes are consecutive.
uint64_t code_of(const Size3& chunk)
{
    return spread(uint64_t(chunk.x)) | spread(uint64_t(chunk.y)) << 1 | spread(uint64_t(chunk.z)) << 2;
}

glm::ivec3 chunk_of(uint64_t code)
{
    glm::ivec3 chunk(0);
    for (int bit = 0; bit < CODE_BITS; ++bit)
        for (int axis = 0; axis < 3; ++axis) chunk[axis] |= int(code >> (3 * bit + axis) & 1) << bit;
    return chunk;
}

using Codes = std::span<const uint64_t>;

/// Whether any of `codes`, sorted codes of chunks in the cube of 2^bits chunks per side at `corner`, lies in `box`.
bool any_in(Codes codes, const Size3& corner, int bits, const VoxelBox& box)
{
    const Size3 end = corner + (int64_t{1} << bits);
    if (codes.empty() || glm::any(glm::greaterThanEqual(corner, box.upper)) ||
        glm::any(glm::lessThanEqual(end, box.lower)))
        return false;
    if (glm::all(glm::greaterThanEqual(corner, box.lower)) && glm::all(glm::lessThanEqual(end, box.upper))) return true;
    const uint64_t first = code_of(corner);
    for (int octant = 0; octant < 8; ++octant) {
        const uint64_t from = first + (uint64_t(octant) << 3 * (bits - 1));
        const auto lower = std::ranges::lower_bound(codes, from);
        const auto upper = std::ranges::lower_bound(codes, from + (uint64_t{1} << 3 * (bits - 1)));
        const Size3 half = Size3(octant & 1, octant >> 1 & 1, octant >> 2) << int64_t{bits - 1};
        if (any_in({lower, upper}, corner + half, bits - 1, box)) return true;
    }
    return false;
}

}  // namespace

/// The known facts about a level. All members are guarded by `mutex`.
struct ZarrGaps::Level {
    std::mutex mutex{};
    std::optional<std::vector<uint64_t>> codes{};     ///< codes of all stored chunks, ascending
    int64_t more_than = 0;                            ///< lower bound of the number of stored chunks if there were
                                                      ///< too many to list
    bool is_unlistable = false;                       ///< set if a name or the index of a shard could not be read
    std::unordered_map<uint64_t, bool> is_missing{};  ///< results of probes

    void list(const ZarrVolume& volume, int64_t most)
    {
        if (codes || most <= more_than) return;
        std::vector<uint64_t> found;
        if (!volume.list_stored(most, [&](const Size3& chunk) { found.push_back(code_of(chunk)); })) {
            more_than = most;
            return;
        }
        std::ranges::sort(found);
        codes = std::move(found);
        is_missing = {};
    }
    /// Lists the chunks if possible. Ignores failures, which are reported by the read that needs the data.
    void try_to_list(const ZarrVolume& volume)
    {
        if (is_unlistable) return;
        try {
            list(volume, MAX_LISTED);
        } catch (const Error&) {
            is_unlistable = true;
        }
    }
    bool look_up(const ZarrVolume& volume, const Size3& chunk)
    {
        const auto [at, is_new] = is_missing.try_emplace(code_of(chunk));
        if (is_new) at->second = volume.is_missing(chunk);
        return at->second;
    }
};

ZarrGaps::ZarrGaps(const std::vector<ZarrVolume>& levels) : volumes_(levels)
{
    for (size_t level = 0; level < levels.size(); ++level) levels_.push_back(std::make_unique<Level>());
}

ZarrGaps::~ZarrGaps() = default;

std::optional<ValueRange> ZarrGaps::range(int level, const VoxelBox& box) const
{
    // Remote chunks are not looked up: callers are drawing a picture, and must not wait for a network.
    if (volumes_[size_t(level)].is_remote()) return std::nullopt;
    ValueRange range{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
    for (int below = level; below >= 0; --below) {
        if (!are_missing(below, chunks_below(level, box, below)).value_or(false)) return std::nullopt;
        const ZarrVolume& volume = volumes_[size_t(below)];
        // If the array was removed, it is unknown which chunks it had.
        if (!volume.is_there()) return std::nullopt;
        const double fill = volume.fill();
        if (!std::isfinite(fill)) continue;
        range.lower = std::min(range.lower, fill);
        range.upper = std::max(range.upper, fill);
    }
    return range;
}

std::optional<std::vector<glm::ivec3>> ZarrGaps::stored(int level, int64_t most) const
{
    if (volumes_[size_t(level)].is_remote()) return std::nullopt;
    Level& known = *levels_[size_t(level)];
    const std::scoped_lock lock(known.mutex);
    known.list(volumes_[size_t(level)], most);
    if (!known.codes || int64_t(known.codes->size()) > most) return std::nullopt;
    std::vector<glm::ivec3> chunks;
    chunks.reserve(known.codes->size());
    for (const uint64_t code : *known.codes) chunks.push_back(chunk_of(code));
    std::ranges::sort(chunks, [](const glm::ivec3& a, const glm::ivec3& b) {
        return std::tie(a.z, a.y, a.x) < std::tie(b.z, b.y, b.x);
    });
    return chunks;
}

ZarrGaps::Chunks ZarrGaps::chunks_below(int level, const VoxelBox& box, int below) const
{
    const ZarrVolume& volume = volumes_[size_t(below)];
    const int64_t factor = int64_t{1} << (level - below);
    // Clamped, since a level whose size was rounded down lacks its last voxels: the last stored voxels replace them.
    const Size3 lower = glm::min(box.lower * factor, volume.size() - int64_t{1});
    const Size3 upper = glm::min(box.upper * factor, volume.size());
    return {lower / volume.chunk(), (upper - int64_t{1}) / volume.chunk() + int64_t{1}};
}

std::optional<bool> ZarrGaps::are_missing(int level, const Chunks& chunks) const
{
    const ZarrVolume& volume = volumes_[size_t(level)];
    const Size3 extent = chunks.end - chunks.begin;
    const double files = double(extent.x) * double(extent.y) * double(extent.z);
    Level& known = *levels_[size_t(level)];
    const std::scoped_lock lock(known.mutex);
    if (files > double(FEW_FILES) || known.is_missing.size() > MANY_LOOKS) known.try_to_list(volume);
    if (known.codes) return !any_in(*known.codes, Size3(0), CODE_BITS, {chunks.begin, chunks.end});
    if (files > double(MAX_FILES)) return std::nullopt;
    Size3 at;
    for (at.z = chunks.begin.z; at.z < chunks.end.z; ++at.z)
        for (at.y = chunks.begin.y; at.y < chunks.end.y; ++at.y)
            for (at.x = chunks.begin.x; at.x < chunks.end.x; ++at.x)
                if (!known.look_up(volume, at)) return false;
    return true;
}

}  // namespace shvr

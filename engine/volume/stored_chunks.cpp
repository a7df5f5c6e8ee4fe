#include "engine/volume/stored_chunks.h"

#include <algorithm>
#include <span>

#include "engine/volume/grid.h"
#include "engine/volume/voxel_walk.h"

namespace shvr {
namespace {

/// Bits per axis of a key. 14 would suffice for chunks, since a side has at most MAX_SIDE voxels.
constexpr int KEY_BITS = 20;

/// Removes duplicates, which occur because several small blocks intersect the same chunk.
void make_unique(std::vector<uint64_t>& keys)
{
    std::ranges::sort(keys);
    const auto repeated = std::ranges::unique(keys);
    keys.erase(repeated.begin(), repeated.end());
}

/// Returns the first chunk that is not listed, with x fastest.
std::optional<Size3> first_absent(const StoredChunks& chunks)
{
    for (size_t i = 0; i <= chunks.keys.size() && double(i) < chunks.all(); ++i) {
        const Size3 chunk = position_of(int64_t(i), chunks.counts);
        if (!std::ranges::binary_search(chunks.keys, interleaved(chunk))) return chunk;
    }
    return std::nullopt;
}

}  // namespace

uint64_t interleaved(const Size3& chunk)
{
    uint64_t key = 0;
    for (int bit = 0; bit < KEY_BITS; ++bit)
        for (int axis = 0; axis < 3; ++axis) key |= (uint64_t(chunk[axis]) >> bit & 1) << (3 * bit + axis);
    return key;
}

Size3 uninterleaved(uint64_t key)
{
    Size3 chunk(0);
    for (int bit = 0; bit < KEY_BITS; ++bit)
        for (int axis = 0; axis < 3; ++axis) chunk[axis] |= int64_t(key >> (3 * bit + axis) & 1) << bit;
    return chunk;
}

std::optional<std::vector<uint64_t>> chunk_keys(const StoredBlocks& stored, const Size3& size, const VoxelBox& box,
                                                int64_t most)
{
    std::vector<uint64_t> keys;
    const auto limit = size_t(std::max<int64_t>(1024, 2 * most));
    for (const glm::ivec3& block : stored.blocks) {
        const VoxelBox whole = box_of_block(stored, block, size);
        const VoxelBox part{glm::max(whole.lower, box.lower) - box.lower, glm::min(whole.upper, box.upper) - box.lower};
        if (glm::any(glm::greaterThanEqual(part.lower, part.upper))) continue;
        const Size3 lower = part.lower / STORED_CHUNK, upper = (part.upper + (STORED_CHUNK - 1)) / STORED_CHUNK;
        for (int64_t z = lower.z; z < upper.z; ++z)
            for (int64_t y = lower.y; y < upper.y; ++y)
                for (int64_t x = lower.x; x < upper.x; ++x) {
                    keys.push_back(interleaved({x, y, z}));
                    if (keys.size() < limit) continue;
                    make_unique(keys);
                    if (int64_t(keys.size()) > most) return std::nullopt;
                }
    }
    make_unique(keys);
    if (int64_t(keys.size()) > most) return std::nullopt;
    return keys;
}

std::optional<StoredChunks> chunks_in(const VolumeSource& source, const VoxelBox& box, int64_t most)
{
    const std::optional<StoredBlocks> stored = source.stored_blocks(0, std::min(most, MAX_STORED_BLOCKS));
    if (!stored) return std::nullopt;
    std::optional<std::vector<uint64_t>> keys = chunk_keys(*stored, source.info().size, box, most);
    if (!keys) return std::nullopt;
    StoredChunks chunks{.counts = (box.size() + (STORED_CHUNK - 1)) / STORED_CHUNK,
                        .keys = *std::move(keys),
                        .blocks = int64_t(stored->blocks.size())};
    const std::optional<Size3> absent = first_absent(chunks);
    if (!absent) return std::nullopt;
    const Size3 voxel = box.lower + *absent * STORED_CHUNK;
    source.read({voxel, voxel + int64_t{1}}, std::span(chunks.fill).first(bytes_of(source.info().type)));
    return chunks;
}

}  // namespace shvr

#include "engine/device/device_volume.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "engine/base/error.h"
#include "engine/volume/grid.h"

namespace shvr {

RegionBricks bricks_around(const VoxelBox& voxels)
{
    constexpr int64_t SIZE = gpu::BRICK_SIZE;
    const Size3 first = voxels.lower / SIZE, end = (voxels.upper - int64_t{1}) / SIZE + int64_t{1};
    return {.begin = glm::uvec3(first), .counts = glm::uvec3(end - first), .slots = {}};
}

std::vector<BrickKey> bricks_that_see(std::span<const VoxelBox> boxes, const Size3& size, int level)
{
    const Size3 most = size_of_level(size, level) - int64_t{1};
    std::vector<BrickKey> keys;
    std::unordered_set<BrickKey, BrickKeyHash> known;
    for (const VoxelBox& box : boxes) {
        if (glm::any(glm::greaterThanEqual(box.lower, box.upper))) continue;
        const int64_t side = int64_t{1} << level;
        const Size3 first = glm::max(box.lower / side - int64_t{gpu::BRICK_APRON}, Size3(0)) / int64_t{gpu::BRICK_SIZE};
        const Size3 last =
            glm::min((box.upper - int64_t{1}) / side + int64_t{gpu::BRICK_APRON}, most) / int64_t{gpu::BRICK_SIZE};
        for (int64_t z = first.z; z <= last.z; ++z)
            for (int64_t y = first.y; y <= last.y; ++y)
                for (int64_t x = first.x; x <= last.x; ++x)
                    if (const BrickKey key{level, {x, y, z}}; known.insert(key).second) keys.push_back(key);
    }
    return keys;
}

uint32_t slot_at(uint32_t index, const glm::uvec3& slots)
{
    return gpu::pack_slot(glm::uvec3(position_of(index, slots)));
}

namespace {

uint64_t max_slots_a_side(uint32_t brick_texels, uint32_t max_side)
{
    return std::min<uint64_t>(max_side / brick_texels, 255);  // pack_slot's 8 bits
}

}  // namespace

uint64_t max_atlas_slots(uint32_t brick_texels, uint32_t max_side)
{
    const uint64_t most = max_slots_a_side(brick_texels, max_side);
    return most * most * most;
}

glm::uvec3 atlas_layout(uint64_t slots, uint32_t brick_texels, uint32_t max_side, bool narrow)
{
    const uint64_t most = max_slots_a_side(brick_texels, max_side);
    const auto ceil_div = [](uint64_t a, uint64_t b) { return (a + b - 1) / b; };
    uint64_t x =
        narrow ? std::min<uint64_t>(8, most) : std::min<uint64_t>(most, uint64_t(std::ceil(std::cbrt(double(slots)))));
    while (x < most && ceil_div(slots, x) > most * most) ++x;
    x = std::min(x, slots);
    const uint64_t rows = ceil_div(slots, x);
    const uint64_t y = std::min<uint64_t>(most, uint64_t(std::ceil(std::sqrt(double(rows)))));
    const uint64_t z = ceil_div(rows, y);
    if (z > most) fail("what is shown needs ", slots, " bricks on the device; its images hold ", most * most * most);
    return {uint32_t(x), uint32_t(y), uint32_t(z)};
}

bool is_by_address(const gpu::DeviceTraits& traits, AtlasCodes codes, uint64_t bytes)
{
    // Kernels count words with a sign.
    const uint64_t most = std::min({traits.max_allocation_bytes, traits.max_buffer_bytes, uint64_t{1} << 33});
    return traits.reads_by_address && codes != AtlasCodes::filtered && bytes <= most;
}

std::optional<StackedLayout> stacked_layout(uint64_t slots, AtlasCodes codes, const gpu::DeviceTraits& traits)
{
    const uint32_t side = traits.limits.maxImageDimension3D;
    const uint64_t most =
        std::min(traits.max_volume_bytes / slot_code_bytes(codes), max_atlas_slots(gpu::BRICK_TEXELS, side));
    if (slots == 0 || most == 0) return std::nullopt;
    if (slots <= max_atlas_slots(gpu::BRICK_TEXELS, side)) {
        const StackedLayout layout{atlas_layout(slots, gpu::BRICK_TEXELS, side, traits.is_cpu), 1, true};
        if (is_by_address(traits, codes, layout.count() * slot_code_bytes(codes))) return layout;
    }
    for (uint32_t images = 1; images <= gpu::MAX_ATLASES; ++images) {
        const uint64_t each = (slots + images - 1) / images;
        if (each > most) continue;
        const StackedLayout layout{atlas_layout(each, gpu::BRICK_TEXELS, side, traits.is_cpu), images};
        // Checks the rounded-up layout, which may exceed the limits; an address has only 8 bits along z.
        if (layout.count() <= most * images && layout.all().z <= 255) return layout;
    }
    return std::nullopt;
}

}  // namespace shvr

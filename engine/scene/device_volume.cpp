#include "engine/scene/device_volume.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"

namespace shvr {

RegionBricks bricks_around(const VoxelBox& voxels)
{
    constexpr int64_t SIZE = gpu::BRICK_SIZE;
    const Size3 first = voxels.lower / SIZE, end = (voxels.upper - int64_t{1}) / SIZE + int64_t{1};
    return {.begin = glm::uvec3(first), .counts = glm::uvec3(end - first), .slots = {}};
}

uint32_t slot_at(uint32_t index, const glm::uvec3& slots)
{
    return gpu::pack_slot({index % slots.x, index / slots.x % slots.y, index / (slots.x * slots.y)});
}

glm::uvec3 atlas_layout(uint64_t slots, uint32_t brick_texels, uint32_t max_side, bool narrow)
{
    const uint64_t most = std::min<uint64_t>(max_side / brick_texels, 255);  // pack_slot's 8 bits
    const auto ceil_div = [](uint64_t a, uint64_t b) { return (a + b - 1) / b; };
    uint64_t x = narrow ? 8 : std::min<uint64_t>(most, uint64_t(std::ceil(std::cbrt(double(slots)))));
    while (x < most && ceil_div(slots, x) > most * most) ++x;
    x = std::min(x, slots);
    const uint64_t rows = ceil_div(slots, x);
    const uint64_t y = std::min<uint64_t>(most, uint64_t(std::ceil(std::sqrt(double(rows)))));
    const uint64_t z = ceil_div(rows, y);
    if (z > most) fail("the volume needs ", slots, " bricks on the device; its textures hold ", most * most * most);
    return {uint32_t(x), uint32_t(y), uint32_t(z)};
}

}  // namespace shvr

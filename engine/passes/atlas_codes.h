#pragma once
// The layout of codes in the atlas. Paged bricks are in slots, with aprons; bricks of a resident volume are contiguous,
// within a border (shaders/bricks.h). In every layout, kernels read the same 16-bit codes.

#include <cstdint>

#include "engine/graph/frame_graph.h"
#include "shaders/bricks.h"

namespace shvr {

enum class AtlasCodes : uint8_t {
    exact16,   ///< r32ui, two codes (along x) per texel, for exact sampling
    exact8,    ///< r32ui, four codes (along x) per texel, for 8-bit volumes, whose codes are multiples of 257
    filtered,  ///< R16_UNORM, for the device's texture filter
};

/// Size of one code.
constexpr uint32_t code_bytes(AtlasCodes codes)
{
    return codes == AtlasCodes::exact8 ? 1 : 2;
}

/// Codes per texel, along x.
constexpr uint32_t codes_a_texel(AtlasCodes codes)
{
    return codes == AtlasCodes::filtered ? 1 : 4 / code_bytes(codes);
}

/// Device bytes of a slot's codes.
inline uint64_t slot_code_bytes(AtlasCodes codes)
{
    const glm::uvec3 of_codes = gpu::slot_codes(code_bytes(codes));
    return uint64_t{of_codes.x} * of_codes.y * of_codes.z * code_bytes(codes);
}

/// An image of `extent` codes, or a buffer of them that kernels read by its address.
inline ResourceDesc atlas_desc(AtlasCodes codes, const glm::uvec3& extent, bool by_address)
{
    const glm::uvec3 texels = extent / glm::uvec3(codes_a_texel(codes), 1, 1);
    if (by_address) return words_desc(texels);
    return image_desc(codes == AtlasCodes::filtered ? Format::r16_unorm : Format::r32_uint, texels);
}

/// Size in codes of an image with this many contiguous bricks, including the border.
inline glm::uvec3 codes_side_by_side(const glm::uvec3& brick_counts)
{
    return gpu::BRICK_SIZE * brick_counts + 2u * gpu::code_border();
}

}  // namespace shvr

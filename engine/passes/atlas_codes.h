#pragma once
// How codes lie in the atlas: of paged bricks in slots, with aprons; of a resident volume's side by side, in a border
// (shaders/bricks.h). Whatever the form, kernels see 16-bit codes, and the same ones.

#include <cstdint>

#include "engine/graph/frame_graph.h"
#include "shaders/bricks.h"

namespace shvr {

enum class AtlasCodes : uint8_t {
    exact16,   ///< r32ui, two codes along x in a texel, for exact sampling
    exact8,    ///< r32ui, four codes along x in a texel: of volumes of bytes, whose codes are multiples of 257
    filtered,  ///< R16_UNORM, for the device's filter
};

/// Of one code.
constexpr uint32_t code_bytes(AtlasCodes codes)
{
    return codes == AtlasCodes::exact8 ? 1 : 2;
}

/// Along x.
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

/// An image of so many codes along each axis.
inline ResourceDesc atlas_desc(AtlasCodes codes, const glm::uvec3& extent)
{
    return image_desc(codes == AtlasCodes::filtered ? Format::r16_unorm : Format::r32_uint,
                      extent / glm::uvec3(codes_a_texel(codes), 1, 1));
}

/// The codes of a volume of so many bricks side by side, border included.
inline glm::uvec3 codes_side_by_side(const glm::uvec3& brick_counts)
{
    return gpu::BRICK_SIZE * brick_counts + 2u * gpu::code_border();
}

}  // namespace shvr

#pragma once
// The handles of a volume on the device, as passes use them.

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/graph/frame_graph.h"
#include "engine/passes/atlas_codes.h"
#include "shaders/bricks.h"

namespace shvr {

/// Handles of paged bricks (shaders/pages.h).
struct PageBinding {
    Resource directory;
    Resource cell_leap;     ///< r8ui per cell of every slot
    Resource reached;       ///< one bit per entry, set by a ray that visits the entry's brick
    bool feedback = false;  ///< whether rays mark the entries of `reached`
    glm::uvec3 counts{1};
    uint32_t cell_shift = 0;
    uint32_t depth = 0;
};

struct VolumeBinding {
    Resource atlas;  ///< bricks with their aprons, in the layout of `codes`
    /// Further images of the atlas, of the same size (shaders/library/atlas.glsl), stacked along z; for paged volumes.
    std::vector<Resource> more_atlases;
    Resource cell_ranges;  ///< r32ui per cell of the volume or of the slots: minimum | maximum << 16
    // Resident volumes:
    Resource page_table;                   ///< uint per brick: slot
    Resource leap;                         ///< r32ui per cell, see shaders/leap.h
    std::array<Resource, 2> leap_scratch;  ///< r32ui per four cells along x: what stages of the leap grid hand on
    std::optional<Resource> sample_bits;   ///< r32ui, two per cell (shaders/leap.h); optional, only for exact
                                           ///< texels
    // Paged volumes:
    std::optional<PageBinding> pages;
    glm::uvec3 brick_counts{1};
    glm::uvec3 cell_counts{1};
    AtlasCodes codes = AtlasCodes::exact16;
    bool by_address = false;  ///< the atlas is a buffer of words, without `more_atlases`
    bool in_slots = false;    ///< paged bricks, with aprons

    bool is_filtered() const { return codes == AtlasCodes::filtered; }
};

/// The constants of kernels that read codes (shaders/library/atlas.glsl). `is_stacked`: whether the kernel supports
/// stacked images.
inline std::vector<std::pair<std::string, uint32_t>> constants_of_codes(const VolumeBinding& volume, bool is_stacked)
{
    std::vector<std::pair<std::string, uint32_t>> constants;
    if (is_stacked) constants.emplace_back("ATLASES", uint32_t(1 + volume.more_atlases.size()));
    if (volume.is_filtered()) return constants;
    constants.emplace_back("CODE_BYTES", code_bytes(volume.codes));
    if (volume.by_address) constants.emplace_back("BY_ADDRESS", 1);
    return constants;
}

/// Binds the first image of the atlas and, if it has one, its buffer. Returns the image; of an atlas in a buffer it is
/// another of the format, which kernels never read.
inline Resource bind_first_atlas(Pass& pass, const VolumeBinding& volume)
{
    if (volume.by_address) {
        pass.read("atlas_at", volume.atlas);
    } else if (!volume.is_filtered()) {
        constexpr std::array<uint32_t, 6> NOWHERE{};
        pass.block("atlas_at", std::span<const uint32_t>(NOWHERE));
    }
    const Resource image = volume.by_address ? volume.cell_ranges : volume.atlas;
    pass.read("atlas", image);
    return image;
}

/// Binds the atlas to a kernel that supports stacked images. If the atlas has fewer images than bindings, the other
/// bindings get the first image, which kernels never read through these bindings.
inline void bind_stacked_atlas(Pass& pass, const VolumeBinding& volume)
{
    const Resource first = bind_first_atlas(pass, volume);
    for (size_t i = 0; i + 1 < gpu::MAX_ATLASES; ++i)
        pass.read("atlas_" + std::to_string(i + 1), i < volume.more_atlases.size() ? volume.more_atlases[i] : first);
}

/// Binds the atlas to a kernel that supports stacked images only for paged bricks.
inline void bind_atlas(Pass& pass, const VolumeBinding& volume)
{
    if (volume.pages)
        bind_stacked_atlas(pass, volume);
    else
        bind_first_atlas(pass, volume);
}

/// Binds the atlas and sets its constants.
inline void read_atlas(Pass& pass, const VolumeBinding& volume)
{
    for (const auto& [name, value] : constants_of_codes(volume, volume.pages.has_value())) pass.constant(name, value);
    bind_atlas(pass, volume);
}

/// The bricks of a region of level 0, and their slots.
struct RegionBricks {
    glm::uvec3 begin{0}, counts{1};
    std::vector<uint32_t> slots;  ///< x fastest
};

/// The painted voxels on the device; null while nothing is painted.
struct MaskBinding {
    Resource mask;        ///< r8ui, bricks without aprons
    Resource mask_table;  ///< slots of painted bricks, see shaders/library/mask.glsl
};

}  // namespace shvr

#pragma once
// Which voxels around the probe are relevant (at or above the haptic threshold), as the servo sees them: a grid of
// bits, held by value, with its position, level, age and the settings that produced it. A compute pass fills the grid
// (or the host, engine/live/relevance_host.h); the host publishes it through `Latest`. Plain data that never allocates.

#include <array>
#include <cstddef>
#include <cstdint>

#include <glm/glm.hpp>

namespace shvr {

/// The part of a ball whose relevance is known. Planes cut the ball at equal distances on both sides of its centre, so
/// that a part missing on one side causes no pull towards the other.
struct KnownPart {
    glm::dvec3 reach{0.0};  ///< distance of the planes from the centre along each axis, at most the radius
    double share =
        0.0;  ///< share of the ball's volume; 0 if the centre is unknown. Exact for one cut; for several cuts, a
              ///< product of shares
};

struct RelevancePatch {
    static constexpr int32_t MAX_VOXELS = 128;  ///< per side
    static constexpr size_t MAX_WORDS = size_t(MAX_VOXELS) * MAX_VOXELS * MAX_VOXELS / 32;

    uint64_t sequence = 0;  ///< 0: nothing is known yet
    uint64_t time_ns = 0;   ///< time of the request, CLOCK_MONOTONIC; later changes are not in the bits
    glm::ivec3 origin{0};   ///< voxel of the patch's lower corner
    glm::ivec3 size{0};     ///< voxels, at most MAX_VOXELS per axis; clipped to the volume: nothing outside is relevant
    int32_t words_per_row = 0;  ///< 32-bit words along x: bit b of word w is voxel x = origin.x + 32 w + b
    glm::dvec3 spacing{1.0};    ///< physical size of a voxel of this level
    glm::ivec3 volume_size{0};  ///< voxels of its level
    int32_t level = 0;          ///< a voxel of level l spans 2^l of the volume's along each axis; coarse levels are for
                                ///< large probes
    uint32_t settings = 0;      ///< ForceSettings::relevance_settings used; if it changes, the patch is unusable
    uint32_t limits = 0;        ///< counts changes of excluded voxels (cuts, hidden groups), which cross-fade the pull
    std::array<uint32_t, MAX_WORDS> words{};  ///< index of a word: word + words_per_row * (y + size.y * z)

    uint32_t row_word(int32_t word, int32_t y, int32_t z) const
    {
        return words[size_t(word) + size_t(words_per_row) * (size_t(y) + size_t(size.y) * size_t(z))];
    }
    size_t word_count() const { return size_t(words_per_row) * size_t(size.y) * size_t(size.z); }
    /// Returns whether the patch's dimensions are consistent with each other and with the array.
    bool is_well_formed() const;
    /// Copies everything except the words.
    void take_place_of(const RelevancePatch& other);
    /// Returns whether the patch covers the ball's part in the volume. Physical units: the corner of voxel (0, 0, 0) is
    /// the origin, and voxel i has its centre at (i + 0.5) * spacing. False while nothing is known yet.
    bool covers(const glm::dvec3& centre, double radius) const;
    /// Returns the known part of the ball: the whole ball if covers() is true.
    KnownPart known_part(const glm::dvec3& centre, double radius) const;
};

}  // namespace shvr

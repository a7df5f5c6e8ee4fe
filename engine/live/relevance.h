#pragma once
// Computes which voxels around a point can be felt: those at or above a threshold, in a cube, as bits. The device
// computes them and the host collects the answer some milliseconds later, without waiting.
//
// One thread, the renderer's.

#include <optional>
#include <vector>

#include "engine/live/region_query.h"

namespace shvr {

/// Bits of a box of voxels: bit b of word w of row (y, z) is voxel x = box.lower.x + 32 w + b.
struct RelevanceBits {
    VoxelBox box;
    int64_t words_per_row = 0;
    std::vector<uint32_t> words;  ///< index of a word: word + words_per_row * (y + size.y * z)
    uint64_t asked_ns = 0;        ///< the time passed to `ask`; the data is at least that recent
    double gpu_ms = 0.0;          ///< 0 where the device has no timestamps
    int level = 0;                ///< level of the voxels
};

/// A cube of voxels around a ball, at a level that suits the ball. Its side is 64 voxels; 96 or 128 if the ball would
/// leave a smaller cube before the next one arrives; 128 if the radius exceeds 24 voxels. Radii above 48 voxels use
/// coarser levels, and so do radii above 24 voxels in fast motion.
struct RelevancePlace {
    /// Maximum radius of a ball, in voxels of its level; larger balls use a coarser level, if one exists.
    static constexpr double MAX_BALL_RADIUS = 48.0;
    /// Motion asks for a coarser level only if the ball has that many voxels there.
    static constexpr double MIN_COARSE_RADIUS = 12.0;
    int level = 0;
    Size3 level_size{0};      ///< voxels of the level
    glm::dvec3 spacing{1.0};  ///< voxel size of the level
    VoxelBox box;             ///< inside the level
    bool operator==(const RelevancePlace&) const = default;
    /// Whether the box holds all of the ball (physical) that lies in the volume.
    bool covers(const glm::dvec3& centre, double radius) const;
};

class Relevance {
public:
    static constexpr int64_t SIDE = 64, MOVING_SIDE = 96, LARGE_SIDE = 128;  ///< voxels

    explicit Relevance(Renderer& renderer) : renderer_(renderer), query_(renderer, "mirror relevance") {}

    /// Queries the cube around a point (voxels), clipped to the volume. Drops an answer not yet taken. Submits nothing
    /// while bricks of the cube are being loaded. Fails if the point is not finite.
    void ask(const glm::dvec3& voxel, double threshold, uint64_t now_ns);
    /// Likewise for a box of level 0. Fails if the device has no room for its bricks.
    void ask(const VoxelBox& box, double threshold, uint64_t now_ns);
    bool is_asking() const { return query_.is_asking(); }
    void drop() { query_.drop(); }
    /// The answer; null until the device has finished.
    std::optional<RelevanceBits> take();

private:
    Renderer& renderer_;
    RegionQuery query_;
    uint64_t asked_ns_ = 0;
};

}  // namespace shvr

#pragma once
// Computes which voxels around a point can be felt: bits of the voxels in a cube that are at or above a threshold. The
// device computes the bits, and the host collects them some milliseconds later, without waiting.
//
// Used only by the renderer's thread.

#include <optional>
#include <vector>

#include "engine/live/region_query.h"

namespace shvr {

/// One bit per voxel of a box: bit b of word w of row (y, z) is voxel x = box.lower.x + 32 w + b.
struct RelevanceBits {
    VoxelBox box;
    int64_t words_per_row = 0;
    std::vector<uint32_t> words;  ///< word w of row (y, z) is at index w + words_per_row * (y + size.y * z)
    uint64_t asked_ns = 0;        ///< the time passed to `ask`; the data is as recent or more recent
    double gpu_ms = 0.0;          ///< 0 where the device has no timestamps
    int level = 0;                ///< level of the voxels
};

/// A cube of voxels around a ball, at a level that suits the ball. The cube's side is 64 voxels; 96 or 128 if the ball
/// would leave a smaller cube before the next cube arrives; 128 if the ball's radius exceeds 24 voxels. Radii above 48
/// voxels, and radii above 24 voxels in fast motion, use coarser levels.
struct RelevancePlace {
    /// Maximum radius of a ball, in voxels of the cube's level. Larger balls use a coarser level, if there is one.
    static constexpr double MAX_BALL_RADIUS = 48.0;
    /// Fast motion selects a coarser level only if the ball's radius is at least this many voxels of that level.
    static constexpr double MIN_COARSE_RADIUS = 12.0;
    int level = 0;
    Size3 level_size{0};      ///< number of voxels of the level along each axis
    glm::dvec3 spacing{1.0};  ///< voxel size of the level
    VoxelBox box;             ///< inside the level
    bool operator==(const RelevancePlace&) const = default;
    /// Whether the box contains the part of the ball (in physical units) that is inside the volume.
    bool covers(const glm::dvec3& centre, double radius) const;
};

class Relevance {
public:
    static constexpr int64_t SIDE = 64, MOVING_SIDE = 96, LARGE_SIDE = 128;  ///< voxels

    explicit Relevance(Renderer& renderer) : renderer_(renderer), query_(renderer, "mirror relevance") {}

    /// Queries the cube around a point (in voxels), clipped to the volume. Drops an answer that was not taken yet.
    /// Submits nothing while the cube's bricks are being loaded. Fails if the point is not finite.
    void ask(const glm::dvec3& voxel, double threshold, uint64_t now_ns);
    /// Like ask() above, but queries a box of level 0. Fails if the device has no room for the box's bricks.
    void ask(const VoxelBox& box, double threshold, uint64_t now_ns);
    bool is_asking() const { return query_.is_asking(); }
    void drop() { query_.drop(); }
    /// Returns the answer; null until the device has finished.
    std::optional<RelevanceBits> take();

private:
    Renderer& renderer_;
    RegionQuery query_;
    uint64_t asked_ns_ = 0;
};

}  // namespace shvr

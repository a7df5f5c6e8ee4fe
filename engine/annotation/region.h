#pragma once
// The local region of a brush (a ball or a box around the probe), and sets of selected voxels.
//
// A region is a list of row spans: for each (y, z) of its box, the half-open range of x that belongs to the region. The
// spans are computed here, once and in double precision. Brush kernels only intersect the spans with the voxels they
// select, so the CPU and the device cannot disagree about a voxel on the region's surface.

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "engine/annotation/mask.h"
#include "engine/volume/volume.h"
#include "shaders/regions/regions.h"

namespace shvr {

enum class RegionShape { ball, box };

struct BrushRegion {
    VoxelBox box;                    ///< clipped to the volume; may be empty
    std::vector<gpu::RowSpan> rows;  ///< box.size().y * box.size().z spans, y fastest, x relative to box.lower.x
    bool contains(const Size3& voxel) const;
    /// Number of 32-bit words per row: bit b of word w is voxel x = box.lower.x + 32 w + b.
    int64_t words_per_row() const { return (box.size().x + 31) / 32; }
};

/// A voxel belongs to the ball if the distance of its centre from `centre_voxel`, in physical units, is at most the
/// radius: `radius_voxels` * spacing.x. The box uses the same radius along each axis independently. Fails if the
/// region's box, with rows padded to whole words, holds more than 256^3 voxels.
BrushRegion make_region(RegionShape shape, const glm::dvec3& centre_voxel, double radius_voxels,
                        const glm::dvec3& spacing, const Size3& volume_size);

/// Fails if the region of a brush with this radius would be too large at some position in a volume of that size.
void check_radius(double radius_voxels, const glm::dvec3& spacing, const Size3& volume_size);

/// The probe's positions along a stroke: the points of `path`, with equally spaced points inserted so that successive
/// positions are at most one voxel apart along every axis. A path of one point gives one position. Fails if there are
/// more than MAX_STROKE_POSITIONS.
std::vector<glm::dvec3> stroke_positions(std::span<const glm::dvec3> path);
/// Number of `stroke_positions`, without computing them; infinite if points of the path are too far apart for a double.
double stroke_position_count(std::span<const glm::dvec3> path);
inline constexpr int64_t MAX_STROKE_POSITIONS = 1'000'000;

/// A set of voxels in sparse bricks of 32^3 bits.
class VoxelSelection {
public:
    explicit VoxelSelection(Size3 size);
    /// Adds the voxels of `region` whose bit is set; `words` has rows of `BrushRegion::words_per_row`.
    void add(const BrushRegion& region, std::span<const uint32_t> words);
    bool contains(const Size3& voxel) const;
    int64_t count() const;
    using Bits = std::array<uint32_t, VOXELS_PER_BRICK / 32>;
    const std::map<int64_t, Bits>& bricks() const { return bricks_; }

private:
    Size3 size_;
    glm::i64vec3 counts_;
    std::map<int64_t, Bits> bricks_;
};

}  // namespace shvr

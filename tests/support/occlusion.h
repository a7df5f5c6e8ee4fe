#pragma once
// Shared by tests of local ambient occlusion: scenes, the device's values, and the reference's values.

#include <vector>

#include "tests/reference/occlusion.h"
#include "tests/support/gpu.h"

namespace shvr::test {

/// Lit by ambient light alone.
Session occluded(std::vector<ControlPoint> points, double radius = 16.0, const glm::uvec2& pixels = {48, 40});
Camera overview(const TestVolume& volume);
/// Blobs with soft edges: surfaces, gaps, and an inside.
TestVolume blobs(const glm::ivec3& size, const glm::dvec3& spacing = glm::dvec3(1.0));

/// The device's values for all voxels of a resident volume, 0 ... 1.
std::vector<double> occlusion_values(Renderer& renderer, const glm::ivec3& size);
std::vector<double> occlusion_values(OnDevice& device);

/// The reference's values for a volume whose intensities are codes. Copies neither.
class ExpectedOcclusion {
public:
    ExpectedOcclusion(const TestVolume& volume, const Session& session);
    /// Opacity of a unit; 0 outside the volume and where it is cut away.
    double opacity(const glm::ivec3& voxel) const;
    /// The value as the device computes it, sample by sample.
    double by_taps(const glm::ivec3& voxel) const;
    /// The value by the definition, between voxels.
    double defined(const glm::ivec3& voxel, uint32_t directions, int steps) const;

private:
    /// Table of the transfer function: opacities of a stretch, and prefix sums over the entries, as on the device.
    struct Table {
        std::vector<double> opacities, sums, squares;
    };
    Table table_of(double stretch) const;
    /// The opacity at a code, and the two sums up to there.
    glm::dvec3 sums_at(const Table& table, double code) const;
    double code(const glm::ivec3& at) const;
    bool is_kept(const glm::ivec3& at) const;
    bool is_beyond_plane(const glm::dvec3& voxel) const;
    double opacity_of_code(double code) const;
    reference::OcclusionRamp ramp_of(const Table& table, double middle, const glm::dvec3& slope, double least,
                                     double most, double steepest) const;
    reference::OcclusionRamp ramp_of_voxel(const glm::ivec3& at) const;
    reference::OcclusionRamp ramp_of_cell(const glm::ivec3& cell) const;
    reference::OcclusionSide side(const glm::ivec3& at) const;
    reference::OcclusionAsked asked() const;
    reference::OcclusionRays rays() const;

    const TestVolume& volume_;
    const Session& session_;
    Samples samples_;   ///< the function, as sampled in the device's table
    Table near_, far_;  ///< over a tap in voxels, in cells of 2
    std::vector<double> opacities_;
};

}  // namespace shvr::test

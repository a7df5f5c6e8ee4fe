#pragma once
// Deterministic volumes with a known value and gradient, for tests, benchmarks and goldens. They need no file, and no
// voxel is stored: `read` evaluates the function. Equal parameters give equal bits on every machine: the noise is an
// integer hash instead of library random numbers, and where possible, transcendental functions do not affect the
// rounding of a voxel.

#include <array>

#include "engine/volume/source.h"

namespace shvr {

/// A scalar field in voxel coordinates (the centre of voxel i is at i + 0.5), in intensity units.
struct ScalarField {
    std::function<double(glm::dvec3 voxel)> value;
    /// The derivative d value / d voxel; where it jumps, the derivative on one side. Empty if no derivative is useful
    /// (speckles). For `tubes` it excludes the noise, which is constant within a voxel and jumps at the voxel's faces.
    std::function<glm::dvec3(glm::dvec3 voxel)> gradient;
};

struct ProceduralSpec {
    std::string kind = "tubes";  ///< one of `procedural_kinds()`
    Size3 size{64};              ///< voxels
    uint32_t seed = 1;
    VoxelType type = VoxelType::uint8;
    glm::dvec3 spacing{1.0};
    std::string unit = "voxel";
    /// Number of levels. Every level samples the same function, at the centres of its own voxels. 0: one level or, for
    /// volumes of more than 2^33 voxels, as many as are needed for a coarsest level of one brick. On each level, tubes
    /// are drawn at least 1.5 voxels thick; otherwise they would fall between the centres of voxels.
    int levels = 0;
    bool operator==(const ProceduralSpec&) const = default;
};

/// Voxels have the field's value at their centres, rounded half up; for int8 every intensity is lowered by 128, so that
/// none is clamped.
///
/// constant        every voxel 128.
/// ramp            rises along x from 0 at voxel centre 0 to 250 at the last centre.
/// sphere          radial ramp: 125 on the sphere of radius 0.35 * shortest side, slope 250 over a quarter of that
///                 side, clamped.
/// marschner_lobb  Marschner and Lobb 1994, f_M = 6, alpha = 0.25, over [-1,1]^3, scaled to 0 ... 250.
/// tubes           bent and branching tubes of several radii (profile soft over 2 voxels): background 40, tubes up to
///                 220, normal noise with a standard deviation of 3 % of the difference.
/// speckles        small balls scattered at random, no two of which touch: background 20, balls 200.
/// fog             smooth value noise, 60 ... 160 everywhere: nothing to skip.
/// checker         one voxel 50, its neighbours 200: the highest frequency a grid holds. Trilinear between voxels.
/// chirality       a ball off the centre, 250, with an arm along each axis towards its end, the longest along x (200),
///                 a shorter one along y (150), the shortest along z (100); background 20. Every mirrored or exchanged
///                 axis shows, from one voxel up. All parts are sharp, and known (ProceduralTruth).
std::vector<std::string> procedural_kinds();

/// Fails with a message that lists the kinds if `spec.kind` is unknown.
ScalarField procedural_field(const ProceduralSpec& spec);
std::unique_ptr<VolumeSource> open_procedural(const ProceduralSpec& spec);

/// The known content of a volume, to draw, trace or export it.
struct ProceduralTruth {
    /// Returns the colour group at a position in voxel coordinates; 0: background.
    std::function<uint8_t(const glm::dvec3& voxel)> group;
    struct Node {
        glm::dvec3 voxel{0.0};
        double radius_voxels = 1.0;
        uint8_t group = 1;
    };
    std::vector<Node> nodes;                   ///< along the centre lines
    std::vector<std::array<size_t, 2>> links;  ///< internodes; a link has the group of its second node
};
/// Returns the known content; null for kinds whose content is not known. Fails like `open_procedural`.
std::optional<ProceduralTruth> procedural_truth(const ProceduralSpec& spec);

}  // namespace shvr

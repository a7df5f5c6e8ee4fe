#pragma once
// The surfaces of all groups with fewer triangles, in memory. The triangles between two groups, or between a group and
// unpainted voxels, are a patch, which is made coarser once; both groups get its triangles. Vertices along the borders
// of patches, where three groups meet, stay. Whichever groups are visited, they are the same. One thread.

#include "engine/annotation/meshes/group_surfaces.h"

namespace shvr {

struct DecimationOptions {
    double share = 1.0;       ///< how much of each patch's triangles stays, above 0
    glm::dvec3 spacing{1.0};  ///< as that of the surfaces
    uint64_t memory = 0;      ///< bytes that all this may take; 0: no limit
    Progress progress{};
};

/// The largest relative change of a group's volume.
inline constexpr double MAX_DECIMATION_CHANGE = 0.004;

class DecimatedSurfaces {
public:
    DecimatedSurfaces(GroupSurfaces& surfaces, const DecimationOptions& options);

    GroupSurfaces::Size size_of(uint8_t group) const;
    void for_each_vertex(uint8_t group, const GroupSurfaces::VisitVertex& visit, const Progress& progress = {}) const;
    void for_each_triangle(uint8_t group, const GroupSurfaces::VisitTriangle& visit,
                           const Progress& progress = {}) const;

    /// Every vertex of the full surfaces is within this distance of the coarse ones, and every point of the coarse ones
    /// within it of the full ones, in the unit of the spacing. It is at most the shortest side of a voxel.
    double error() const { return error_; }

private:
    struct Mesh {
        std::vector<glm::dvec3> vertices;  ///< in voxels
        std::vector<glm::uvec3> triangles;
    };
    class Patches;
    std::array<Mesh, 256> meshes_;
    double error_ = 0.0;
};

}  // namespace shvr

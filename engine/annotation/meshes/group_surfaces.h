#pragma once
// The surface of each group of a mask as a closed mesh of triangles, which are counter-clockwise seen from outside.
// Positions are in voxels, from the outer corner of voxel 0.
//
// Meshes are made where they are visited: in memory are only the points that surfaces share (surface_points.h). Where
// two groups touch, both meshes have the same positions and the same triangles, in opposite directions, whichever
// groups are visited. The mask must not change meanwhile. One thread.

#include <functional>

#include "engine/annotation/meshes/surface_faces.h"

namespace shvr {

struct SurfaceOptions {
    int steps = 0;            ///< of smoothing (surface_smoothing.h)
    glm::dvec3 spacing{1.0};  ///< decides which diagonal of a face is shorter
    uint64_t memory = 0;      ///< bytes that the points may take; 0: no limit
    Progress progress{};
};

class GroupSurfaces {
public:
    GroupSurfaces(const Mask& mask, const SurfaceOptions& options);

    struct Size {
        uint64_t vertices = 0, triangles = 0;
        bool operator==(const Size&) const = default;
    };
    /// 0 if the group is not painted.
    const Size& size_of(uint8_t group) const { return sizes_[group]; }

    using VisitVertex = std::function<void(const glm::dvec3& position)>;
    /// Indices count from 0, in the order of `for_each_vertex`.
    using VisitTriangle = std::function<void(const glm::uvec3& indices, const std::array<glm::dvec3, 3>& positions)>;
    void for_each_vertex(uint8_t group, const VisitVertex& visit, const Progress& progress = {}) const;
    void for_each_triangle(uint8_t group, const VisitTriangle& visit, const Progress& progress = {});
    /// The same triangles in the same order, with the group on their other side (0: unpainted). The triangles between
    /// two groups come in one order, whichever of the two is visited; the last two corners are exchanged.
    using VisitBorderTriangle = std::function<void(const glm::uvec3& indices, uint8_t other)>;
    void for_each_border_triangle(uint8_t group, const VisitBorderTriangle& visit, const Progress& progress = {});

    /// Cost: cells of 32^3 corners with a surface, and the points in them.
    size_t cells() const { return points_.cells().size(); }
    uint32_t points() const { return points_.count(); }

private:
    void count(const Progress& progress);
    template <class Visit>
    void visit_triangles(uint8_t group, const Visit& visit, const Progress& progress);
    void number_vertices(uint8_t group);

    SurfacePoints points_;
    glm::dvec3 spacing_;
    SurfaceOffsets offsets_;
    std::array<Size, 256> sizes_{};
    std::vector<uint32_t> first_vertex_;  ///< for each point, the first vertex of group `numbered_`
    uint8_t numbered_ = 0;
};

}  // namespace shvr

#pragma once
// How far points and triangles are from a surface that lies near them. The triangles of the surface are found by a grid
// of cells about as large as they are. Pure; any thread.

#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace shvr {

using TriangleCorners = std::array<glm::dvec3, 3>;

/// The squared distance of a point from a triangle (Ericson 2005, 5.1.5).
double squared_distance(const glm::dvec3& point, const TriangleCorners& triangle);

class SurfaceDistance {
public:
    /// `reach`: the largest distance that is found. Takes at most 60 bytes for each triangle, with its share of the
    /// positions. There is at least one triangle.
    SurfaceDistance(std::vector<glm::dvec3> positions, std::vector<glm::uvec3> triangles, double reach);

    const std::vector<glm::dvec3>& positions() const { return positions_; }

    /// The distance of a point from the surface, or infinity if it is larger than `reach`. `nearest`: a triangle that
    /// is looked at first, then the nearest one. Ends at the first triangle that is within `enough`.
    double from(const glm::dvec3& point, double enough, uint32_t& nearest) const;
    /// Whether every point of the triangle is within `reach`. May be false if some are only just.
    bool reaches(const TriangleCorners& triangle) const;
    /// Raises `least` to the distance of the farthest point that was looked at, and returns a distance that no point
    /// of the triangle exceeds: at most a quarter of `reach` more than `least`. The triangle is one that `reaches`.
    double farthest(const TriangleCorners& triangle, double& least) const;

private:
    glm::ivec3 cell_of(const glm::dvec3& point) const { return {glm::floor((point - origin_) / side_)}; }
    /// No point of the piece is farther than this from the triangle of the surface.
    double squared_bound(const TriangleCorners& piece, uint32_t triangle) const;
    size_t bucket_of(const glm::ivec3& cell) const;
    TriangleCorners corners(uint32_t triangle) const;

    std::vector<glm::dvec3> positions_;
    std::vector<glm::uvec3> triangles_;
    double reach_;
    glm::dvec3 half_{0.0};                ///< half the size of the largest box of a triangle
    glm::dvec3 origin_{0.0}, side_{1.0};  ///< corner of cell 0, size of each cell
    std::vector<uint32_t> first_;         ///< for each bucket of cells, its first one in `sorted_`; then their end
    std::vector<uint32_t> sorted_;        ///< triangles by the cell that their box has its middle in
};

}  // namespace shvr

#pragma once
// The density as a continuous field: trilinear between voxel centres, clamped to the edge voxels outside.

#include "tests/reference/scene.h"

namespace shvr::reference {

/// Eight neighbouring voxels, inside which the field is one trilinear polynomial.
struct Cell {
    glm::dvec3 low_centre{0.5};       ///< voxel space, centre of corners[0]
    std::array<double, 8> corners{};  ///< x fastest
};

Cell cell_at(const Scene& scene, const glm::dvec3& voxel);

/// Exact at the corners, and exactly constant where the corners agree. Positions outside the cell are clamped to it.
double value_in(const Cell& cell, const glm::dvec3& voxel);

double density_at(const Scene& scene, const glm::dvec3& voxel);

/// Central difference over one voxel (half a voxel to each side), per voxel.
glm::dvec3 difference_at(const Scene& scene, const glm::dvec3& voxel);

/// Derivative of density_at() inside the cell of that position, per voxel; 0 along an axis outside all centres.
glm::dvec3 slope_at(const Scene& scene, const glm::dvec3& voxel);

/// The one that the scene's shading uses, in physical space, per reference voxel: divided by the spacing, times the
/// reference length.
glm::dvec3 gradient_at(const Scene& scene, const glm::dvec3& voxel);

/// Label of the voxel at the position; 0 if the scene has no labels.
uint8_t label_at(const Scene& scene, const glm::dvec3& voxel);

double reference_length(const Scene& scene);

}  // namespace shvr::reference

#pragma once
// Smooths surfaces and keeps the volume of each group. One thread.

#include "engine/annotation/meshes/surface_faces.h"

namespace shvr {

/// A point stays within this distance of its corner along each axis, in voxels: less than half, so that no two points
/// meet.
inline constexpr float MAX_SURFACE_OFFSET = 0.49F;
/// The largest relative difference between a group's volume and that of its voxels.
inline constexpr double MAX_VOLUME_CHANGE = 0.005;

/// The volume that the surface of each group encloses, in voxels, by the divergence theorem.
std::array<double, 256> enclosed_volumes(const SurfacePoints& points, const SurfaceOffsets& offsets,
                                         const glm::dvec3& spacing, const Progress& progress = {});

/// Returns offsets after `steps` steps, in each of which every point moves half the way to the mean of its neighbours;
/// then points move along the normals of their groups until all volumes are kept. Points where three groups meet (or
/// two and unpainted voxels) follow only neighbours along such lines. 0 steps: all offsets are 0.
SurfaceOffsets smoothed(const SurfacePoints& points, int steps, const glm::dvec3& spacing, const Progress& progress);

}  // namespace shvr

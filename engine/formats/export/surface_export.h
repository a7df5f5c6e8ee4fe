#pragma once
// Closed surfaces in files of other programs, written part by part, so that memory does not depend on their size. The
// extension determines the format:
//
//   .stl   binary; one part; float32 corners of each triangle
//   .ply   binary; float64 vertices with colours; each face has the property `group`
//   .obj   text; a group "group_N" for each part
//   .glb   binary glTF 2.0; a mesh and a material for each part. Positions are float32, relative to `origin`, which the
//          node adds again, and the node converts to metres. The axes are those of the other formats
//
// Any thread.

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "engine/base/progress.h"

namespace shvr {

struct SurfacePart {
    int group = 0;
    std::string name;
    glm::dvec3 color{1.0};  ///< linear light
    uint64_t vertices = 0, triangles = 0;
};

/// The surfaces to write. Each visit gives the same vertices and triangles.
class SurfaceParts {
public:
    virtual ~SurfaceParts() = default;
    using VisitVertex = std::function<void(const glm::dvec3& position)>;
    /// Indices count from 0 in each part.
    using VisitTriangle = std::function<void(const glm::uvec3& indices, const std::array<glm::dvec3, 3>& positions)>;
    virtual void for_each_vertex(const SurfacePart& part, const VisitVertex& visit, const Progress& progress) = 0;
    virtual void for_each_triangle(const SurfacePart& part, const VisitTriangle& visit, const Progress& progress) = 0;

    std::vector<SurfacePart> parts;
    std::vector<std::string> comments;  ///< lines about unit and place, for formats that have comments
    glm::dvec3 origin{0.0};             ///< a position near all vertices
    std::optional<double> metres;       ///< length of the unit; null if it is no length
};

/// The extensions of the formats.
const std::vector<std::string>& surface_extensions();
/// Whether files with this name hold one part.
bool holds_one_surface(const std::filesystem::path& path);

/// Writes as AtomicWriter does. Fails before it writes if the disk has too little space, or if the format cannot hold
/// that many vertices.
void export_surfaces(const std::filesystem::path& path, SurfaceParts& surfaces, const Progress& progress);

}  // namespace shvr

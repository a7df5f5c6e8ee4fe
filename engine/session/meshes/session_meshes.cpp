#include "engine/session/meshes/session_meshes.h"

#include "engine/annotation/trace/trace_space.h"
#include "engine/base/error.h"
#include "engine/base/image.h"
#include "engine/formats/meshes/mesh_file.h"
#include "engine/volume/unit.h"

namespace shvr {

namespace {

constexpr glm::dvec3 PLAIN_COLOR(200.0 / 255.0, 180.0 / 255.0, 140.0 / 255.0);  ///< sRGB

glm::dvec3 linear_of(const glm::dvec3& srgb)
{
    return {srgb_decode(srgb.x), srgb_decode(srgb.y), srgb_decode(srgb.z)};
}

/// The length of a mesh's unit in the volume's unit.
double scale_of(const TriangleMesh& mesh, const VolumeInfo& volume)
{
    const std::optional<double> micrometres = micrometres_in(volume.unit);
    return mesh.metres && micrometres ? 1e6 * *mesh.metres / *micrometres : 1.0;
}

MeshShape shape_of(const TriangleMesh& mesh, const MeshLook& look, const VolumeInfo& volume)
{
    const TraceSpace space = space_of(volume);
    const double scale = scale_of(mesh, volume);
    MeshShape shape;
    shape.name = look.file;
    shape.points.reserve(mesh.points.size());
    for (const glm::vec3& point : mesh.points) {
        const glm::dvec3 at = scale * glm::dvec3(point);
        shape.points.push_back(mesh.positions == "volume" ? at : position_of(space, at));
    }
    shape.triangles = mesh.triangles;
    for (const MeshPart& part : mesh.parts) {
        shape.colors.push_back(look.color.value_or(linear_of(part.color ? glm::dvec3(*part.color) : PLAIN_COLOR)));
        shape.color_ends.push_back(part.end);
    }
    return shape;
}

}  // namespace

ReadMeshes read_meshes(const Session& session, const VolumeInfo& volume, uint64_t memory, const Progress& progress)
{
    ReadMeshes read;
    std::vector<MeshShape> shapes;
    for (const MeshLook& look : session.meshes) {
        if (!look.shown) continue;
        try {
            shapes.push_back(shape_of(read_mesh(mesh_path(session, look), memory, progress), look, volume));
        } catch (const Error& error) {
            read.failures.push_back(error.what());
        }
    }
    try {
        read.tree = mesh_tree(shapes, volume);
    } catch (const Error& error) {
        read.failures.push_back(error.what());
    }
    return read;
}

}  // namespace shvr

#include "engine/session/meshes/session_meshes.h"

#include "engine/annotation/trace/trace_space.h"
#include "engine/base/error.h"
#include "engine/base/image.h"
#include "engine/formats/meshes/mesh_file.h"
#include "engine/look/surfaces/mesh_limits.h"
#include "engine/session/meshes/mesh_place.h"
#include "engine/volume/unit.h"

namespace shvr {

namespace {

constexpr glm::dvec3 PLAIN_COLOR(200.0 / 255.0, 180.0 / 255.0, 140.0 / 255.0);  ///< sRGB

glm::dvec3 linear_of(const glm::dvec3& srgb)
{
    return {srgb_decode(srgb.x), srgb_decode(srgb.y), srgb_decode(srgb.z)};
}

struct PlacedMesh {
    MeshShape shape;
    std::string warning{};
};

/// Fails if the mesh cannot be read or drawn. `before`: triangles of other meshes in the picture.
PlacedMesh placed_mesh(const std::filesystem::path& path, const MeshLook& look, const VolumeInfo& volume,
                       uint64_t memory, size_t before, const Progress& progress)
{
    TriangleMesh mesh = read_mesh(path, memory, progress);
    if (mesh.triangles.size() > MAX_TRIANGLES_SHOWN - before)
        fail(path.string(), ": has ", mesh.triangles.size(), " triangles; expected at most ",
             MAX_TRIANGLES_SHOWN - before,
             before == 0 ? ": " : ", which the meshes before it leave: ", "decimate it, or hide other meshes");
    PlacedMesh placed;
    placed.shape.name = path.string();
    const MeshPlace place(mesh, volume);
    placed.shape.points.reserve(mesh.points.size());
    for (const glm::vec3& point : mesh.points) placed.shape.points.push_back(place.in_volume(point));
    check_places(placed.shape, volume);
    placed.warning = place.why_unseen(placed.shape);
    placed.shape.triangles = std::move(mesh.triangles);
    for (const MeshPart& part : mesh.parts) {
        placed.shape.colors.push_back(
            look.color.value_or(linear_of(part.color ? glm::dvec3(*part.color) : PLAIN_COLOR)));
        placed.shape.color_ends.push_back(part.end);
    }
    return placed;
}

/// Memory of a mesh while the tree of all meshes is made.
uint64_t bytes_of(const MeshShape& shape)
{
    return sizeof(glm::dvec3) * shape.points.size() +
           (sizeof(glm::uvec3) + TREE_BYTES_PER_TRIANGLE) * shape.triangles.size();
}

/// Fails, naming the mesh, if it takes more than is left.
void take_memory(const MeshShape& shape, uint64_t memory, uint64_t& taken)
{
    const uint64_t bytes = bytes_of(shape);
    if (bytes > memory - taken)
        fail(shape.name, ": takes ", (bytes >> 20) + 1, " MiB of memory to be drawn; expected at most ",
             (memory - taken) >> 20, " MiB, which ", taken == 0 ? "it may take" : "the meshes before it leave",
             ": decimate it, hide other meshes, or allow more memory");
    taken += bytes;
}

}  // namespace

ReadMeshes read_meshes(const Session& session, const VolumeInfo& volume, uint64_t memory, const Progress& progress)
{
    ReadMeshes read;
    std::vector<MeshShape> shapes;
    size_t triangles = 0;
    uint64_t taken = 0;
    for (const MeshLook& look : session.meshes) {
        if (!look.shown) continue;
        try {
            PlacedMesh placed =
                placed_mesh(mesh_path(session, look), look, volume, memory - taken, triangles, progress);
            take_memory(placed.shape, memory, taken);
            triangles += placed.shape.triangles.size();
            shapes.push_back(std::move(placed.shape));
            if (!placed.warning.empty()) read.warnings.push_back(std::move(placed.warning));
        } catch (const Error& error) {
            read.failures.emplace_back(look.file, error.what());
        }
    }
    read.tree = mesh_tree(shapes, volume);
    return read;
}

MeshCheck check_mesh(const std::filesystem::path& path, const VolumeInfo& volume, uint64_t memory,
                     const Progress& progress)
{
    const PlacedMesh placed = placed_mesh(path, {}, volume, memory, 0, progress);
    uint64_t taken = 0;
    take_memory(placed.shape, memory, taken);
    return {placed.shape.triangles.size(), placed.warning};
}

}  // namespace shvr

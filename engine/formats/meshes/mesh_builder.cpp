#include "engine/formats/meshes/mesh_builder.h"

#include <algorithm>
#include <utility>

#include "engine/base/text.h"

namespace shvr {
namespace {

constexpr size_t MAX_PARTS = size_t{1} << 16;
constexpr size_t MAX_NAME_BYTES = 200;

/// Without control characters, and cut between two characters of UTF-8.
std::string shown_name(std::string_view name)
{
    name = trimmed(name);
    size_t end = std::min(name.size(), MAX_NAME_BYTES);
    if (end < name.size())
        while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0u) == 0x80u) --end;
    return printable(name.substr(0, end));
}

}  // namespace

void refuse_triangles(const std::string& name, uint64_t count)
{
    fail(name, ": holds ", count, " triangles; expected at most ", MAX_MESH_TRIANGLES, ": decimate it");
}

MeshBuilder::MeshBuilder(std::string name, MeshMemory& memory) : name_(std::move(name)), memory_(memory)
{
    mesh_.parts.emplace_back();
}

void MeshBuilder::expect_points(uint64_t count)
{
    if (count > UINT32_MAX) fail(name_, ": holds ", count, " points; expected at most ", UINT32_MAX, ": decimate it");
    memory_.make_room(mesh_.points, count);
}

void MeshBuilder::expect_triangles(uint64_t count)
{
    if (count > MAX_MESH_TRIANGLES) refuse_triangles(name_, count);
    memory_.make_room(mesh_.triangles, count);
}

uint32_t MeshBuilder::add_point(const glm::vec3& at)
{
    if (points() == UINT32_MAX) fail(name_, ": holds more than ", UINT32_MAX, " points; expected fewer: decimate it");
    memory_.append(mesh_.points, at);
    return uint32_t(points() - 1);
}

void MeshBuilder::refuse_coordinate(const std::string& where, int axis, double value)
{
    fail(where, ": has a corner with ", "xyz"[axis], " = ", value, "; expected a finite number of at most 3.4e38");
}

void MeshBuilder::add_triangle(const glm::uvec3& corners)
{
    if (triangles_++ < MAX_MESH_TRIANGLES) memory_.append(mesh_.triangles, corners);
}

void MeshBuilder::begin_part(std::string_view name, const std::optional<glm::vec3>& color, uint64_t begin)
{
    std::string shown = shown_name(name);
    MeshPart& last = mesh_.parts.back();
    if (last.name == shown && last.color == color) return;
    if (last.begin == begin) {  // without triangles
        last.name = std::move(shown);
        last.color = color;
        return;
    }
    if (mesh_.parts.size() == MAX_PARTS)
        fail(name_, ": holds more than ", MAX_PARTS, " parts; expected at most that many: join some of them");
    memory_.take(2 * sizeof(MeshPart) + shown.size());
    mesh_.parts.push_back({std::move(shown), color, uint32_t(std::min(begin, MAX_MESH_TRIANGLES)), 0});
}

TriangleMesh MeshBuilder::finish()
{
    if (triangles_ > MAX_MESH_TRIANGLES) refuse_triangles(name_, triangles_);
    if (triangles_ == 0) fail(name_, ": holds no triangles; expected at least one");
    if (mesh_.parts.back().begin == triangles_) mesh_.parts.pop_back();
    for (size_t i = 0; i < mesh_.parts.size(); ++i)
        mesh_.parts[i].end = i + 1 < mesh_.parts.size() ? mesh_.parts[i + 1].begin : uint32_t(triangles_);
    return std::move(mesh_);
}

}  // namespace shvr

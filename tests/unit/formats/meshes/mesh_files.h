#pragma once
// Shared by the tests of engine/formats/meshes: small meshes as the bytes of their files.

#include <cstring>
#include <string>
#include <vector>

#include "engine/formats/meshes/mesh_file.h"
#include "tests/support/volume_files.h"

namespace shvr::test {

inline constexpr uint64_t MESH_MEMORY = uint64_t{64} << 20;

/// Values in the byte order of the machine, one after another.
template <class... Values>
std::string raw(const Values&... values)
{
    std::string bytes;
    const auto add = [&](const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
    (add(values), ...);
    return bytes;
}

template <class Value>
std::string swapped(Value value)
{
    std::string bytes = raw(value);
    return {bytes.rbegin(), bytes.rend()};
}

inline TriangleMesh mesh_of(const TemporaryFolder& folder, const std::string& name, const std::string& content,
                            uint64_t memory = MESH_MEMORY)
{
    const std::filesystem::path path = folder.write(name, content);
    CHECK(is_mesh_file(path));
    return read_mesh(path, memory, {});
}

inline std::string refusal_of(const TemporaryFolder& folder, const std::string& name, const std::string& content,
                              uint64_t memory = MESH_MEMORY)
{
    const std::filesystem::path path = folder.write(name, content);
    const std::string message = error_of([&] { static_cast<void>(read_mesh(path, memory, {})); });
    CHECK(message.starts_with(path.string()));
    return message;
}

/// Checks that a file which is cut anywhere is refused, or read as a mesh of fewer triangles.
inline void check_cuts(const TemporaryFolder& folder, const std::string& name, const std::string& content,
                       size_t accepted_from)
{
    for (size_t cut = 0; cut < content.size(); ++cut) {
        const std::filesystem::path path = folder.write(name, content.substr(0, cut));
        const std::string message = error_of([&] { static_cast<void>(read_mesh(path, MESH_MEMORY, {})); });
        CHECK_MESSAGE(message.empty() == (cut >= accepted_from), cut, ": ", message);
        CHECK((message.empty() || message.starts_with(path.string())));
    }
}

using Corners = std::vector<std::array<glm::vec3, 3>>;

/// The positions of the corners of each triangle.
inline Corners corners_of(const TriangleMesh& mesh)
{
    Corners corners;
    for (const glm::uvec3& triangle : mesh.triangles)
        corners.push_back({mesh.points.at(triangle.x), mesh.points.at(triangle.y), mesh.points.at(triangle.z)});
    return corners;
}

inline std::string stl_of(const Corners& triangles, std::string header = "a header")
{
    header.resize(80, ' ');
    std::string bytes = header + raw(uint32_t(triangles.size()));
    for (const auto& [a, b, c] : triangles) bytes += raw(glm::vec3(0, 0, 1), a, b, c, uint16_t{0});
    return bytes;
}

inline std::string glb_of(std::string json, const std::string& binary)
{
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const auto size = uint32_t(28 + json.size() + binary.size());
    return "glTF" + raw(uint32_t{2}, size, uint32_t(json.size()), uint32_t{0x4E4F534A}) + json +
           raw(uint32_t(binary.size()), uint32_t{0x004E4942}) + binary;
}

/// The four faces of a tetrahedron, counter-clockwise from outside.
inline const glm::vec3 TETRAHEDRON[] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 4}};
inline const std::vector<glm::uvec3> TETRAHEDRON_FACES = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

inline Corners tetrahedron()
{
    Corners corners;
    for (const glm::uvec3& face : TETRAHEDRON_FACES)
        corners.push_back({TETRAHEDRON[face.x], TETRAHEDRON[face.y], TETRAHEDRON[face.z]});
    return corners;
}

}  // namespace shvr::test

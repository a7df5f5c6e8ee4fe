#include "engine/annotation/trace/trace_mesh.h"

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <numbers>

#include <doctest/doctest.h>

#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// By the divergence theorem; negative where faces look inwards.
double volume_of(const TracePart& part)
{
    double sum = 0.0;
    for (const glm::uvec3& face : part.triangles)
        sum += glm::dot(part.vertices[face.x], glm::cross(part.vertices[face.y], part.vertices[face.z])) / 6.0;
    return sum;
}

/// Whether every edge is passed once in each direction.
bool is_closed(const TracePart& part)
{
    std::map<std::pair<uint32_t, uint32_t>, int> edges;
    for (const glm::uvec3& face : part.triangles)
        for (int corner = 0; corner < 3; ++corner) ++edges[{face[corner], face[(corner + 1) % 3]}];
    for (const auto& [edge, times] : edges)
        if (times != 1 || !edges.contains({edge.second, edge.first})) return false;
    return true;
}

TraceGraph tube()
{
    TraceGraph trace;
    trace.apply(TraceNodeChange{0, {}, TraceNode{{10, 20, 30}, 2, 1}}, Direction::forwards);
    trace.apply(TraceNodeChange{1, {}, TraceNode{{14, 23, 42}, 1, 2}}, Direction::forwards);  // 13 away
    trace.apply(TraceNodeChange{2, {}, TraceNode{{14, 23, 42}, 0, 2}}, Direction::forwards);
    trace.apply(TraceInternodeChange{0, {}, TraceInternode{0, 1, 2}}, Direction::forwards);
    trace.apply(TraceInternodeChange{1, {}, TraceInternode{1, 2, 2}}, Direction::forwards);  // without length
    return trace;
}

}  // namespace

TEST_CASE("a node is a closed ball, seen from outside")
{
    const TracePart ball = mesh_of(TraceNode{{5, -3, 8}, 3.0, 7});
    CHECK(ball.group == 7);
    CHECK(ball.vertices.size() == 42);
    CHECK(ball.triangles.size() == 80);
    CHECK(is_closed(ball));
    for (const glm::dvec3& vertex : ball.vertices)
        CHECK(glm::length(vertex - glm::dvec3(5, -3, 8)) == doctest::Approx(3.0).epsilon(1e-12));
    const double exact = 4.0 / 3.0 * std::numbers::pi * 27.0;
    CHECK(volume_of(ball) > 0.87 * exact);
    CHECK(volume_of(ball) < exact);
    CHECK(mesh_of(TraceNode{{5, -3, 8}, 0.0, 7}).triangles.empty());
}

TEST_CASE("an internode is a closed truncated cone of a regular polygon's volume")
{
    const TraceGraph trace = tube();
    const TracePart cone = mesh_of(trace, trace.internode(0));
    CHECK(is_closed(cone));
    const double per_square = 16.0 / 2.0 * std::sin(2.0 * std::numbers::pi / 16.0);
    CHECK(volume_of(cone) == doctest::Approx(per_square * 13.0 / 3.0 * (4.0 + 2.0 + 1.0)).epsilon(1e-12));
    CHECK(mesh_of(trace, trace.internode(1)).triangles.empty());
}

namespace {

std::string content_of(const std::filesystem::path& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// Reads the vertices of an OBJ.
std::vector<glm::dvec3> vertices_of(const std::string& obj)
{
    std::vector<glm::dvec3> vertices;
    std::istringstream lines(obj);
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with("v ")) continue;
        std::istringstream numbers(line.substr(2));
        glm::dvec3 vertex{0.0};
        numbers >> vertex.x >> vertex.y >> vertex.z;
        vertices.push_back(vertex);
    }
    return vertices;
}

}  // namespace

TEST_CASE("a mesh lies where the volume's file says, to the last bit in OBJ and PLY, and stays closed from outside")
{
    const TemporaryFolder folder;
    TraceSpace space{{9, 9, 9}, {0.5, 0.25, 2}, "um"};
    space.directions = glm::dmat3(glm::dvec3(-1, 0, 0), glm::dvec3(0, -1, 0), glm::dvec3(0, 0, 1));
    space.origin = {1234567, -20, 7};
    space.frame = "LPS";
    save_trace_mesh(folder.path / "volume.obj", tube(), space, Positions::volume);
    save_trace_mesh(folder.path / "a.obj", tube(), space);
    save_trace_mesh(folder.path / "a.ply", tube(), space);
    const std::vector<glm::dvec3> in_volume = vertices_of(content_of(folder.path / "volume.obj"));
    const std::string obj = content_of(folder.path / "a.obj"), ply = content_of(folder.path / "a.ply");
    const std::vector<glm::dvec3> physical = vertices_of(obj);
    REQUIRE(physical.size() == 118);
    const size_t body = ply.find("end_header\n") + 11;
    for (size_t i = 0; i < physical.size(); ++i) {
        REQUIRE(physical[i] == physical_of(space, in_volume[i]));
        glm::dvec3 vertex{0.0};
        std::memcpy(&vertex, ply.data() + body + 24 * i, 24);
        REQUIRE(vertex == physical[i]);
    }
    for (const char* words : {"SPACE=LPS\n", "space physical\n", "origin 1234567 -20 7\n", "frame LPS\n",
                              "directions -1 0 0 0 -1 0 0 0 1\n", "unit um\n"}) {
        CAPTURE(words);
        CHECK(contains(obj, words));
        CHECK(contains(ply.substr(0, body), words));
    }
    CHECK(contains(content_of(folder.path / "volume.obj"), "# space volume\n"));
    CHECK_FALSE(contains(content_of(folder.path / "volume.obj"), "SPACE="));
}

TEST_CASE("OBJ and PLY hold every part, with the unit and the groups")
{
    const TemporaryFolder folder;
    TraceSpace space{{9, 9, 9}, {1, 1, 1}, "um"};
    save_trace_mesh(folder.path / "a.obj", tube(), space);
    CHECK(content_of(folder.path / "a.obj")
              .starts_with("# SHVR trace as tubes, unit um\n# positions are physical, in um"));
    std::ifstream obj(folder.path / "a.obj");
    std::string word;
    std::map<std::string, int> counts;
    std::vector<uint64_t> corners;
    for (std::string line; std::getline(obj, line);) {
        ++counts[line.substr(0, line.find(' '))];
        if (line[0] == 'g') ++counts[line];
        if (line[0] != 'f') continue;
        std::istringstream text(line.substr(2));
        for (uint64_t corner; text >> corner;) corners.push_back(corner);
    }
    CHECK(counts["v"] == 42 + 42 + 34);
    CHECK(counts["f"] == 80 + 80 + 64);
    CHECK(counts["g group_1"] == 1);
    CHECK(counts["g group_2"] == 1);
    CHECK(*std::min_element(corners.begin(), corners.end()) == 1);
    CHECK(*std::max_element(corners.begin(), corners.end()) == 118);

    save_trace_mesh(folder.path / "a.ply", tube(), space);
    const std::string text = content_of(folder.path / "a.ply");
    const size_t end = text.find("end_header\n") + 11;
    CHECK(contains(text.substr(0, end), "unit um"));
    CHECK(contains(text.substr(0, end), "element vertex 118\n"));
    CHECK(contains(text.substr(0, end), "element face 224\n"));
    REQUIRE(text.size() == end + 118 * 24 + 224 * 14);
    uint32_t most = 0;
    std::map<int, int> groups;
    for (size_t face = 0; face < 224; ++face) {
        const char* at = text.data() + end + 118 * 24 + face * 14;
        CHECK(at[0] == 3);
        for (size_t corner = 0; corner < 3; ++corner) {
            uint32_t index = 0;
            std::memcpy(&index, at + 1 + 4 * corner, 4);
            most = std::max(most, index);
        }
        ++groups[at[13]];
    }
    CHECK(most == 117);
    CHECK((groups == std::map<int, int>{{1, 80}, {2, 144}}));
    CHECK(contains(error_of([&] { save_trace_mesh(folder.path / "a.stl", {}, {}); }), "expected .obj or .ply"));
}

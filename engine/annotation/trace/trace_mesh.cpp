#include "engine/annotation/trace/trace_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>
#include <set>
#include <span>
#include <utility>

#include "engine/annotation/trace/trace_forms.h"
#include "engine/base/atomic_writer.h"
#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr {

namespace {

constexpr uint32_t SIDES = 16;
constexpr size_t CHUNK_BYTES = size_t{1} << 20;

/// A sphere of radius 1: an icosahedron subdivided once, with 42 vertices and 80 triangles.
TracePart unit_ball()
{
    const double p = (1.0 + std::sqrt(5.0)) / 2.0;
    TracePart ball;
    ball.vertices = {{-1, p, 0},  {1, p, 0},  {-1, -p, 0}, {1, -p, 0}, {0, -1, p},  {0, 1, p},
                     {0, -1, -p}, {0, 1, -p}, {p, 0, -1},  {p, 0, 1},  {-p, 0, -1}, {-p, 0, 1}};
    constexpr uint32_t FACES[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                       {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                       {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                       {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> halves;
    const auto half = [&](uint32_t a, uint32_t b) {
        const auto [found, is_new] = halves.try_emplace(std::minmax(a, b), uint32_t(ball.vertices.size()));
        if (is_new) ball.vertices.push_back(ball.vertices[a] + ball.vertices[b]);
        return found->second;
    };
    for (const auto& [a, b, c] : FACES) {
        const uint32_t ab = half(a, b), bc = half(b, c), ca = half(c, a);
        const glm::uvec3 quarters[] = {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}};
        ball.triangles.insert(ball.triangles.end(), std::begin(quarters), std::end(quarters));
    }
    for (glm::dvec3& vertex : ball.vertices) vertex = glm::normalize(vertex);
    return ball;
}

template <class Value>
void append_bytes(std::string& bytes, Value value)
{
    static_assert(std::endian::native == std::endian::little);
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes.append(raw, sizeof value);
}

/// Visits every non-empty part, by group.
template <class Visit>
void for_each_part(const TraceGraph& trace, const Visit& visit)
{
    std::set<uint8_t> groups;
    for (const auto& [number, node] : trace.nodes()) groups.insert(node.group);
    for (const auto& [number, internode] : trace.internodes()) groups.insert(internode.group);
    const auto take = [&](const TracePart& part) {
        if (!part.triangles.empty()) visit(part);
    };
    for (const uint8_t group : groups) {
        for (const auto& [number, node] : trace.nodes())
            if (node.group == group) take(mesh_of(node));
        for (const auto& [number, internode] : trace.internodes())
            if (internode.group == group) take(mesh_of(trace, internode));
    }
}

class Chunks {
public:
    explicit Chunks(const std::filesystem::path& path) : writer_(path) {}
    void flush(size_t above = CHUNK_BYTES)
    {
        if (text.size() < above) return;
        writer_.append(std::as_bytes(std::span(text)));
        text.clear();
    }
    void commit()
    {
        flush(0);
        writer_.commit();
    }
    std::string text;

private:
    AtomicWriter writer_;
};

/// Comment lines without line ends.
std::vector<std::string> comments_of_mesh(const TraceSpace& space, Positions positions)
{
    std::vector<std::string> lines{"SHVR trace as tubes, unit " + space.unit, in_words(space, positions)};
    for (const auto& [name, value] : statements_of(space, positions)) lines.push_back(std::string(name) + " " + value);
    if (positions == Positions::physical && !space.frame.empty()) lines.push_back("SPACE=" + space.frame);
    return lines;
}

/// Axes are right-handed, so triangles stay counter-clockwise.
glm::dvec3 written(const TraceSpace& space, Positions positions, const glm::dvec3& vertex)
{
    return positions == Positions::physical ? physical_of(space, vertex) : vertex;
}

void save_obj(const std::filesystem::path& path, const TraceGraph& trace, const TraceSpace& space, Positions positions)
{
    Chunks chunks(path);
    for (const std::string& line : comments_of_mesh(space, positions)) chunks.text += "# " + line + "\n";
    int group = -1;
    uint64_t first = 1;  // vertices count from 1
    for_each_part(trace, [&](const TracePart& part) {
        if (std::exchange(group, part.group) != part.group) chunks.text += "g group_" + std::to_string(group) + "\n";
        for (const glm::dvec3& vertex : part.vertices)
            chunks.text += "v " + digits_of(written(space, positions, vertex)) + "\n";
        for (const glm::uvec3& face : part.triangles)
            chunks.text += sentence("f ", first + face.x, " ", first + face.y, " ", first + face.z, "\n");
        first += part.vertices.size();
        chunks.flush();
    });
    chunks.commit();
}

void save_ply(const std::filesystem::path& path, const TraceGraph& trace, const TraceSpace& space, Positions positions)
{
    uint64_t vertices = 0, triangles = 0;
    for_each_part(trace, [&](const TracePart& part) {
        vertices += part.vertices.size();
        triangles += part.triangles.size();
    });
    if (vertices >> 32 != 0) fail(path.string(), ": would hold ", vertices, " vertices; expected at most 4294967295");
    Chunks chunks(path);
    chunks.text = "ply\nformat binary_little_endian 1.0\n";
    for (const std::string& line : comments_of_mesh(space, positions)) chunks.text += "comment " + line + "\n";
    chunks.text += sentence("element vertex ", vertices, "\nproperty double x\nproperty double y\nproperty double z",
                            "\nelement face ", triangles,
                            "\nproperty list uchar uint vertex_indices\nproperty uchar group\nend_header\n");
    for_each_part(trace, [&](const TracePart& part) {
        for (const glm::dvec3& vertex : part.vertices) {
            const glm::dvec3 position = written(space, positions, vertex);
            for (int axis = 0; axis < 3; ++axis) append_bytes(chunks.text, position[axis]);
        }
        chunks.flush();
    });
    uint32_t first = 0;
    for_each_part(trace, [&](const TracePart& part) {
        for (const glm::uvec3& face : part.triangles) {
            append_bytes(chunks.text, uint8_t{3});
            for (int corner = 0; corner < 3; ++corner) append_bytes(chunks.text, first + face[corner]);
            append_bytes(chunks.text, part.group);
        }
        first += uint32_t(part.vertices.size());
        chunks.flush();
    });
    chunks.commit();
}

}  // namespace

TracePart mesh_of(const TraceNode& node)
{
    static const TracePart unit = unit_ball();
    if (node.radius == 0.0) return {};
    TracePart ball = unit;
    ball.group = node.group;
    for (glm::dvec3& vertex : ball.vertices) vertex = node.position + node.radius * vertex;
    return ball;
}

TracePart mesh_of(const TraceGraph& trace, const TraceInternode& internode)
{
    const glm::dvec3 a = trace.node(internode.a).position, b = trace.node(internode.b).position;
    const double radius_a = trace.radius_of(internode, 0.0), radius_b = trace.radius_of(internode, 1.0);
    if (a == b || (radius_a == 0.0 && radius_b == 0.0)) return {};
    const glm::dvec3 along = glm::normalize(b - a);
    const glm::dvec3 other = std::abs(along.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 u = glm::normalize(glm::cross(other, along)), v = glm::cross(along, u);
    TracePart cone{internode.group, {a, b}, {}};
    for (uint32_t side = 0; side < SIDES; ++side) {
        const double angle = 2.0 * std::numbers::pi * side / SIDES;
        const glm::dvec3 out = std::cos(angle) * u + std::sin(angle) * v;
        cone.vertices.push_back(a + radius_a * out);
        cone.vertices.push_back(b + radius_b * out);
        const uint32_t here = 2 + 2 * side, next = 2 + 2 * ((side + 1) % SIDES);
        const glm::uvec3 faces[] = {
            {here, next, next + 1}, {here, next + 1, here + 1}, {0, next, here}, {1, here + 1, next + 1}};
        cone.triangles.insert(cone.triangles.end(), std::begin(faces), std::end(faces));
    }
    return cone;
}

void save_trace_mesh(const std::filesystem::path& path, const TraceGraph& trace, const TraceSpace& space,
                     Positions positions)
{
    const std::string form = lower_case(path.extension().string());
    if (form == ".obj") return save_obj(path, trace, space, positions);
    if (form == ".ply") return save_ply(path, trace, space, positions);
    fail(path.string(), ": has the extension ", in_quotes(path.extension().string()), "; expected .obj or .ply");
}

}  // namespace shvr

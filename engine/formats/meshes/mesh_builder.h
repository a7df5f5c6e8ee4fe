#pragma once
// Collects the points, triangles and parts of a mesh within the memory it may take. One thread.

#include <limits>
#include <string>
#include <string_view>

#include "engine/formats/meshes/mesh_file.h"
#include "engine/formats/meshes/mesh_memory.h"

namespace shvr {

/// Fails: a mesh of `count` triangles is too large.
[[noreturn]] void refuse_triangles(const std::string& name, uint64_t count);

class MeshBuilder {
public:
    MeshBuilder(std::string name, MeshMemory& memory);

    /// Takes memory for this many points or triangles in all, which the file was checked to hold.
    void expect_points(uint64_t count);
    void expect_triangles(uint64_t count);

    uint64_t points() const { return mesh_.points.size(); }
    uint64_t triangles() const { return triangles_; }
    const glm::vec3& point(uint32_t index) const { return mesh_.points[index]; }

    /// Returns the point's index. `where()`: text for messages, such as "scan.stl: triangle 7".
    template <class Where>
    uint32_t add_point(const glm::dvec3& at, const Where& where)
    {
        return add_point(single_of(at, where));
    }
    uint32_t add_point(const glm::vec3& at);
    /// Converts a position to single precision; fails if it is not finite.
    template <class Where>
    static glm::vec3 single_of(const glm::dvec3& at, const Where& where)
    {
        constexpr double MAX = std::numeric_limits<float>::max();
        for (int axis = 0; axis < 3; ++axis)
            if (!(at[axis] >= -MAX && at[axis] <= MAX)) refuse_coordinate(where(), axis, at[axis]);
        return glm::vec3(at);
    }
    /// Indices of points that exist or will. Triangles beyond the limit are counted only.
    void add_triangle(const glm::uvec3& corners);
    /// Triangles from number `begin` on belong to another part, unless it has the same name and colour as the last.
    void begin_part(std::string_view name, const std::optional<glm::vec3>& color, uint64_t begin);
    void begin_part(std::string_view name) { begin_part(name, std::nullopt, triangles_); }

    /// Fails if there are too many triangles, or none.
    TriangleMesh finish();

private:
    [[noreturn]] static void refuse_coordinate(const std::string& where, int axis, double value);

    std::string name_;
    MeshMemory& memory_;
    TriangleMesh mesh_;
    uint64_t triangles_ = 0;
};

/// The corners of a polygon one after another, as a fan of triangles around the first.
class MeshFan {
public:
    explicit MeshFan(MeshBuilder& builder) : builder_(builder) {}
    void add(uint32_t corner)
    {
        if (corners_ == 0) first_ = corner;
        if (corners_ >= 2) builder_.add_triangle({first_, last_, corner});
        last_ = corner;
        ++corners_;
    }
    uint64_t corners() const { return corners_; }

private:
    MeshBuilder& builder_;
    uint64_t corners_ = 0;
    uint32_t first_ = 0, last_ = 0;
};

}  // namespace shvr

#include "engine/look/surfaces/corner_normals.h"

#include <cmath>

namespace shvr {

namespace {

constexpr double COS_OF_EDGE = 0.8660254037844387;  ///< of 30 degrees
constexpr size_t MAX_COMPARED = 64;

/// The angle between two sides of a triangle; exact near 0 and 180 degrees, too.
double angle_between(const glm::dvec3& p, const glm::dvec3& q)
{
    return std::atan2(glm::length(glm::cross(p, q)), glm::dot(p, q));
}

}  // namespace

CornerNormals::CornerNormals(const MeshShape& mesh)
    : mesh_(mesh), normals_(mesh.triangles.size(), glm::dvec3(0.0)), begins_(mesh.points.size() + 1, 0)
{
    const auto corner = [&](size_t triangle, int i) { return mesh_.points[mesh_.triangles[triangle][i]]; };
    size_t entries = 0;
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        const glm::dvec3 across = glm::cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0));
        const double length = glm::length(across);
        if (!(length > 0.0)) continue;
        normals_[t] = across / length;
        for (int i = 0; i < 3; ++i) ++begins_[mesh.triangles[t][i]];
        entries += 3;
    }
    // From counts to ends; each entry moves the end of its point down to its begin.
    for (size_t point = 1; point < begins_.size(); ++point) begins_[point] += begins_[point - 1];
    entries_.resize(entries);
    for (size_t t = mesh.triangles.size(); t-- > 0;) {
        if (!has_area(t)) continue;
        for (int i = 0; i < 3; ++i) {
            const glm::dvec3 here = corner(t, i);
            const double angle = angle_between(corner(t, (i + 1) % 3) - here, corner(t, (i + 2) % 3) - here);
            entries_[--begins_[mesh.triangles[t][i]]] = {uint32_t(t), float(angle)};
        }
    }
    for (uint32_t point = 0; point < mesh.points.size(); ++point) {
        if (begins_[point + 1] - begins_[point] <= MAX_COMPARED) continue;
        glm::dvec3& sum = joint_[point];
        for (size_t i = begins_[point]; i < begins_[point + 1]; ++i)
            sum += double(entries_[i].angle) * normals_[entries_[i].triangle];
    }
}

glm::dvec3 CornerNormals::at(size_t triangle, int corner) const
{
    const glm::dvec3& own = normals_[triangle];
    const uint32_t point = mesh_.triangles[triangle][corner];
    const size_t begin = begins_[point], end = begins_[point + 1];
    glm::dvec3 sum(0.0);
    if (end - begin > MAX_COMPARED) {
        sum = joint_.at(point);
    } else {
        for (size_t i = begin; i < end; ++i) {
            const glm::dvec3& normal = normals_[entries_[i].triangle];
            if (glm::dot(normal, own) >= COS_OF_EDGE) sum += double(entries_[i].angle) * normal;
        }
    }
    const double length = glm::length(sum);
    return length > 1e-9 ? sum / length : own;
}

}  // namespace shvr

#include "tests/reference/shading.h"

#include <algorithm>
#include <cmath>

#include "tests/reference/field.h"

namespace shvr::reference {

namespace {

/// Linear within a cell, as the density is: what is smooth stays smooth.
double ambient_at(const Scene& scene, const glm::dvec3& voxel)
{
    const Shading& shading = *scene.shading;
    if (shading.ambient_shares.empty()) return shading.ambient;
    const glm::dvec3 lattice = glm::clamp(voxel - 0.5, glm::dvec3(0.0), glm::dvec3(scene.size - 1));
    const glm::ivec3 low = glm::min(glm::ivec3(lattice), glm::max(scene.size - 2, glm::ivec3(0)));
    const glm::dvec3 part = lattice - glm::dvec3(low);
    double share = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::ivec3 bits(corner & 1, corner >> 1 & 1, corner >> 2);
        const glm::ivec3 at = glm::min(low + bits, scene.size - 1);
        double weight = 1.0;
        for (int axis = 0; axis < 3; ++axis) weight *= bits[axis] ? part[axis] : 1.0 - part[axis];
        share +=
            weight * shading.ambient_shares[size_t(at.x) + size_t(scene.size.x) *
                                                               (size_t(at.y) + size_t(scene.size.y) * size_t(at.z))];
    }
    return shading.ambient * share;
}

double surface_weight(double slope, double fade)
{
    if (fade == 0.0) return slope > 1e-6 ? 1.0 : 0.0;
    return slope * slope / (slope * slope + fade * fade);
}

double highlight(const glm::dvec3& normal, const glm::dvec3& to_light, const glm::dvec3& to_eye, double shininess)
{
    const glm::dvec3 sum = to_light + to_eye;
    if (!(glm::dot(normal, to_light) > 0.0) || glm::length(sum) < 1e-6) return 0.0;
    return std::pow(std::max(glm::dot(normal, glm::normalize(sum)), 0.0), shininess);
}

}  // namespace

glm::dvec3 lit(const Scene& scene, const glm::dvec3& voxel, const glm::dvec3& to_eye, const glm::dvec3& color)
{
    if (!scene.shading) return color;
    const Shading& shading = *scene.shading;
    const glm::dvec3 gradient = gradient_at(scene, voxel);
    const double slope = glm::length(gradient);
    const double weight = surface_weight(slope, shading.fade);
    double diffuse = 1.0, glint = 0.0;
    if (weight > 0.0) {
        const glm::dvec3 normal = -gradient / slope;
        const glm::dvec3 to_light = glm::normalize(shading.to_light);
        diffuse = (1.0 - weight) + weight * std::max(glm::dot(normal, to_light), 0.0);
        glint = weight * shading.specular * highlight(normal, to_light, to_eye, shading.shininess);
    }
    return color * (ambient_at(scene, voxel) + shading.diffuse * diffuse) + glint;
}

glm::dvec3 shaded(const Scene& scene, const glm::dvec3& voxel, const glm::dvec3& to_eye, const glm::dvec3& color)
{
    return scene.shading ? glm::min(lit(scene, voxel, to_eye, color), 1.0) : color;
}

}  // namespace shvr::reference

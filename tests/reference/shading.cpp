#include "tests/reference/shading.h"

#include <algorithm>
#include <cmath>

#include "tests/reference/field.h"

namespace shvr::reference {

namespace {

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
    return color * (shading.ambient + shading.diffuse * diffuse) + glint;
}

glm::dvec3 shaded(const Scene& scene, const glm::dvec3& voxel, const glm::dvec3& to_eye, const glm::dvec3& color)
{
    return scene.shading ? glm::min(lit(scene, voxel, to_eye, color), 1.0) : color;
}

}  // namespace shvr::reference

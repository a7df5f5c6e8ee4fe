#include "tests/reference/brute_force.h"

#include <algorithm>
#include <cmath>

namespace shvr::reference {

namespace {

double density(const Scene& scene, glm::dvec3 p)
{
    double sum = 0.0;
    const glm::dvec3 base = glm::floor(p - 0.5);
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1.0;
        glm::ivec3 voxel(0);
        for (int axis = 0; axis < 3; ++axis) {
            const int step = (corner >> axis) & 1;
            const double share = p[axis] - 0.5 - base[axis];
            weight *= step == 1 ? share : 1.0 - share;
            voxel[axis] = std::clamp(int(base[axis]) + step, 0, scene.size[axis] - 1);
        }
        sum += weight * scene.density[size_t(voxel.x + scene.size.x * (voxel.y + scene.size.y * voxel.z))];
    }
    return sum;
}

glm::dvec4 transfer(const std::vector<ControlPoint>& points, double u)
{
    for (size_t i = 0; i + 1 < points.size(); ++i) {
        const ControlPoint &a = points[i], &b = points[i + 1];
        if (u < a.x || u >= b.x) continue;
        const double share = (u - a.x) / (b.x - a.x);
        return {a.color * (1.0 - share) + b.color * share, a.opacity * (1.0 - share) + b.opacity * share};
    }
    return glm::dvec4(0.0);
}

glm::dvec3 lit_by_differences(const Scene& scene, glm::dvec3 p, glm::dvec3 to_eye, glm::dvec3 color)
{
    const Shading& k = *scene.shading;
    const double reference = std::min({scene.spacing.x, scene.spacing.y, scene.spacing.z});
    const glm::dvec3 g(
        (density(scene, p + glm::dvec3(.5, 0, 0)) - density(scene, p - glm::dvec3(.5, 0, 0))) / scene.spacing.x,
        (density(scene, p + glm::dvec3(0, .5, 0)) - density(scene, p - glm::dvec3(0, .5, 0))) / scene.spacing.y,
        (density(scene, p + glm::dvec3(0, 0, .5)) - density(scene, p - glm::dvec3(0, 0, .5))) / scene.spacing.z);
    const double m = glm::length(g) * reference;
    if (m == 0.0) return glm::min(color * (k.ambient + k.diffuse), 1.0);
    const double w = 1.0 / (1.0 + k.fade * k.fade / (m * m));
    const glm::dvec3 n = -glm::normalize(g), l = glm::normalize(k.to_light);
    const double facing = std::max(glm::dot(n, l), 0.0);
    const double mirrored = std::max(glm::dot(n, glm::normalize(l + to_eye)), 0.0);
    const double specular = facing > 0.0 ? std::pow(mirrored, k.shininess) : 0.0;
    return glm::min(color * (k.ambient + k.diffuse * (1.0 - w + w * facing)) + w * k.specular * specular, 1.0);
}

}  // namespace

glm::dvec4 brute_force(const Scene& scene, const Ray& ray, double t_in, double t_out, int samples)
{
    const double reference = std::min({scene.spacing.x, scene.spacing.y, scene.spacing.z});
    const glm::dvec3 physical = ray.direction * scene.spacing;
    const double step = (t_out - t_in) / samples, step_length = step * glm::length(physical) / reference;
    glm::dvec3 light(0.0);
    double depth = 0.0;
    for (int i = 0; i < samples; ++i) {
        const glm::dvec3 p = ray.origin + (t_in + (i + 0.5) * step) * ray.direction;
        glm::dvec4 material = transfer(scene.points, density(scene, p));
        if (!scene.labels.empty()) {
            const glm::ivec3 v(p);
            const uint8_t label = scene.labels[size_t(v.x + scene.size.x * (v.y + scene.size.y * v.z))];
            const Group& group = scene.groups[label];
            if (label != 0) material = glm::dvec4(group.color, group.visible ? group.opacity : 0.0);
        }
        if (material.a == 0.0) continue;
        glm::dvec3 color(material);
        if (scene.shading) color = lit_by_differences(scene, p, -glm::normalize(physical), color);
        const double passed = -step_length * std::log1p(-material.a);
        light += color * (std::exp(-depth) * -std::expm1(-passed));
        depth += passed;
    }
    return {light, -std::expm1(-depth)};
}

}  // namespace shvr::reference

#include "tests/reference/samples.h"

#include <cmath>
#include <numbers>

namespace shvr::reference {

namespace {

// std::uniform_real_distribution may differ between standard libraries.
double uniform(std::mt19937& random)
{
    return double(random()) / 4294967295.0;
}

}  // namespace

Scene scene_of(const glm::ivec3& size, const std::function<double(glm::dvec3 voxel)>& density)
{
    Scene scene{.size = size};
    for (int z = 0; z < size.z; ++z) {
        for (int y = 0; y < size.y; ++y) {
            for (int x = 0; x < size.x; ++x) scene.density.push_back(density(glm::dvec3(x, y, z) + 0.5));
        }
    }
    return scene;
}

Scene noise_scene(const glm::ivec3& size, uint32_t seed)
{
    std::mt19937 random(seed);
    return scene_of(size, [&](glm::dvec3) { return uniform(random); });
}

Ray random_ray(const Scene& scene, std::mt19937& random)
{
    const double z = 2.0 * uniform(random) - 1.0, angle = 2.0 * std::numbers::pi * uniform(random);
    const double r = std::sqrt(1.0 - z * z);
    const glm::dvec3 outwards(r * std::cos(angle), r * std::sin(angle), z);
    const glm::dvec3 size(scene.size);
    const glm::dvec3 eye = 0.5 * size + 1.5 * glm::length(size) * outwards;
    const double x_share = uniform(random), y_share = uniform(random), z_share = uniform(random);
    return {.origin = eye, .direction = glm::dvec3(x_share, y_share, z_share) * size - eye};
}

}  // namespace shvr::reference

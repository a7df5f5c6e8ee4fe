#include "tests/reference/render.h"

#include <algorithm>
#include <stdexcept>
#include <thread>

namespace shvr::reference {

namespace {

bool is_share(double value)
{
    return value >= 0.0 && value <= 1.0;
}

template <class Model>
std::vector<glm::dvec4> render_with(const Model& model, std::span<const Ray> rays, int threads)
{
    std::vector<glm::dvec4> light(rays.size());
    // Every n-th ray: neighbours cost about the same, so the threads finish together.
    const auto every_nth = [&](size_t first) {
        for (size_t i = first; i < rays.size(); i += size_t(threads)) light[i] = model.integrate(rays[i]);
    };
    std::vector<std::jthread> others;
    for (int thread = 1; thread < threads; ++thread) others.emplace_back(every_nth, size_t(thread));
    every_nth(0);
    others.clear();
    return light;
}

}  // namespace

std::vector<glm::dvec4> render(const Scene& scene, std::span<const Ray> rays, const Mode& mode, int threads)
{
    check(scene);
    threads = std::max(threads, 1);
    if (const auto* exact = std::get_if<ExactOptions>(&mode)) {
        return render_with(ExactModel(scene, *exact), rays, threads);
    }
    return render_with(DiscreteModel(scene, std::get<DiscreteOptions>(mode)), rays, threads);
}

glm::dvec4 over_background(const glm::dvec4& light, const Scene& scene)
{
    return glm::dvec4(glm::dvec3(light) + (1.0 - light.a) * scene.background, light.a);
}

void check(const Scene& scene)
{
    const auto require = [](bool claim, const char* sentence) {
        if (!claim) throw std::invalid_argument(sentence);
    };
    const glm::ivec3 size = scene.size;
    require(size.x > 0 && size.y > 0 && size.z > 0, "each side of the reference volume must be above 0");
    const size_t voxels = size_t(size.x) * size_t(size.y) * size_t(size.z);
    require(scene.density.size() == voxels, "the reference volume needs one density per voxel");
    require(scene.labels.empty() || scene.labels.size() == voxels, "the reference volume needs one label per voxel");
    const glm::dvec3 spacing = scene.spacing;
    require(spacing.x > 0.0 && spacing.y > 0.0 && spacing.z > 0.0, "the spacing must be above 0");
    for (const ControlPoint& point : scene.points) require(is_share(point.opacity), "a point's opacity leaves [0, 1]");
    for (const Group& group : scene.groups) require(is_share(group.opacity), "a group's opacity leaves [0, 1]");
}

}  // namespace shvr::reference

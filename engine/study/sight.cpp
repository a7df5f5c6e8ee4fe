#include "engine/study/sight.h"

#include <algorithm>

namespace shvr {

namespace {

constexpr double HALF = 0.70710678118654752440;
constexpr StudyView VIEWS[] = {
    {{0.0, -1.0, 0.0}, {1.0, 0.0, 0.0}},       {{0.0, -HALF, -HALF}, {1.0, 0.0, 0.0}},
    {{0.0, 0.0, -1.0}, {1.0, 0.0, 0.0}},       {{0.0, 1.0, 0.0}, {-1.0, 0.0, 0.0}},
    {{-HALF, -HALF, 0.0}, {HALF, -HALF, 0.0}}, {{HALF, -HALF, 0.0}, {HALF, HALF, 0.0}},
    {{0.0, HALF, -HALF}, {-1.0, 0.0, 0.0}},    {{-1.0, 0.0, 0.0}, {0.0, -1.0, 0.0}},
};

}  // namespace

std::span<const StudyView> study_views()
{
    return VIEWS;
}

bool StudySight::shows(const StudyView& view, const glm::dvec3& voxel, double radius) const
{
    // Starts outside the bundle's own surface, two voxels further, since the picture has half the resolution.
    const double far = glm::length(glm::dvec3(scene_.size()));
    for (double way = 1.5 * radius + 2.0; way < far; way += 1.0) {
        const glm::dvec3 at = voxel + way * view.to_eye;
        if (scene_.shows_surface(glm::ivec3(glm::floor(0.5 * at)))) return false;
    }
    return true;
}

double StudySight::visible_share(const StudyView& view, std::span<const glm::dvec3> voxels, double radius) const
{
    const auto visible = std::ranges::count_if(voxels, [&](const auto& at) { return shows(view, at, radius); });
    return voxels.empty() ? 0.0 : double(visible) / double(voxels.size());
}

size_t StudySight::best_view(size_t present, std::span<const glm::dvec3> voxels, double radius) const
{
    size_t best = present;
    double most = visible_share(VIEWS[present], voxels, radius);
    for (size_t i = 0; i < std::size(VIEWS); ++i) {
        const double share = visible_share(VIEWS[i], voxels, radius);
        if (share > most) best = i, most = share;
    }
    return best;
}

glm::dvec3 StudySight::error_of_glance(const StudyView& view, StudyRandom& random) const
{
    const double scale = scene_.voxels_per_metre();
    const double right = traits_.lateral_m * random.normal(), up = traits_.lateral_m * random.normal();
    const double deep = traits_.depth_m * random.normal();
    return scale * (right * view.right + up * view.up() + deep * view.to_eye);
}

}  // namespace shvr

#include "engine/volume/phantoms/bodies.h"

#include <algorithm>

namespace shvr {

Bodies::Bodies(std::vector<Tube> bodies, std::vector<std::vector<Facet>> facets, const Size3& size, double blur)
    : scene_(std::move(bodies), size, 0.5 * blur), facets_(std::move(facets)), blur_(blur)
{}

Tissue Bodies::over(Tissue around, const glm::dvec3& voxel) const
{
    for (const uint32_t i : scene_.near(voxel)) {
        const Tube& body = scene_.tubes()[i];
        const auto [surface, along] = distance_from(body, voxel);
        double distance = surface;
        if (distance >= 0.5 * blur_) continue;
        const glm::dvec3 d = voxel - body.ends[0];
        for (const Facet& facet : facets_[i])
            distance =
                std::max(distance, d.x * facet.normal.x + d.y * facet.normal.y + d.z * facet.normal.z - facet.distance);
        const double inside = (1.0 - along) * body.intensity[0] + along * body.intensity[1];
        around.intensity += (inside - around.intensity) * cover_of(distance, blur_);
        if (distance <= 0.0) around.group = body.tissue;
    }
    return around;
}

}  // namespace shvr

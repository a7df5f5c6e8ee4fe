#include "engine/session/looks/new_scan.h"

#include <algorithm>

namespace shvr {

void light_new_scan(Session& session, const Size3& size, int64_t most_occluded, std::span<const std::string> settings)
{
    if (std::ranges::any_of(settings, [](const std::string& setting) { return setting.starts_with("light"); })) return;
    constexpr double OCCLUSION = 0.7;
    Light& light = session.light;
    light.ambient = 0.35;  // more than in the examples: occlusion takes away some of it
    light.diffuse = 0.75;
    light.specular = 0.25;
    light.shininess = 40.0;
    if (double(size.x) * double(size.y) * double(size.z) <= double(most_occluded)) light.occlusion.strength = OCCLUSION;
}

}  // namespace shvr

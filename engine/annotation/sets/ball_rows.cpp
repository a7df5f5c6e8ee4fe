#include "engine/annotation/sets/ball_rows.h"

namespace shvr {

std::vector<BallRow> ball_rows(const Reach& reach)
{
    const Size3 most = reach.voxels();
    std::vector<BallRow> rows;
    for (int64_t z = -most.z; z <= most.z; ++z)
        for (int64_t y = -most.y; y <= most.y; ++y) {
            int64_t half = most.x;
            const auto is_beyond = [&] {
                const glm::dvec3 away = glm::dvec3(double(half), double(y), double(z)) * reach.spacing;
                return glm::dot(away, away) > reach.most_squared();
            };
            while (half >= 0 && is_beyond()) --half;
            if (half >= 0) rows.push_back({y, z, half});
        }
    return rows;
}

}  // namespace shvr

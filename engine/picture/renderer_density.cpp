// What the renderer does when density offsets change: bricks, leap grid and ambient occlusion of those voxels are renewed.

#include <algorithm>

#include "engine/picture/renderer.h"
#include "engine/volume/grid.h"

namespace shvr {

void Renderer::update_density(const DensityField& field, std::span<const VoxelBox> changed)
{
    const VolumeInfo& info = volume().info();
    SHVR_CHECK(field.size() == info.size && field.type() == info.type, "the offsets are of another volume");
    std::vector<int64_t> bricks;
    for (const VoxelBox& box : changed) {
        const RegionBricks around = bricks_around(box);
        for (uint32_t z = 0; z < around.counts.z; ++z)
            for (uint32_t y = 0; y < around.counts.y; ++y)
                for (uint32_t x = 0; x < around.counts.x; ++x) {
                    const glm::i64vec3 at(around.begin + glm::uvec3(x, y, z)), counts = field.brick_counts();
                    bricks.push_back(index_of(at, counts));
                }
    }
    std::ranges::sort(bricks);
    bricks.erase(std::ranges::unique(bricks).begin(), bricks.end());
    std::vector<OffsetSource::Brick> offsets;
    for (const int64_t brick : bricks) offsets.push_back({field.position_of(brick), field.brick(brick)});
    offsets_->set(offsets);

    volume_->renew(changed);
    for (const VoxelBox& box : changed) occlusion_.changed(box, gpu::BRICK_APRON);
}

}  // namespace shvr

#include "engine/annotation/mask_file.h"

#include <algorithm>
#include <fstream>

#include "engine/base/atomic_writer.h"
#include "engine/base/error.h"

namespace shvr {

namespace {

constexpr int64_t SIDE = gpu::BRICK_SIZE;

/// The slices of one layer of bricks.
struct Layer {
    Size3 size;
    int64_t first_z;
    int64_t slices() const { return std::min(SIDE, size.z - first_z); }
    size_t bytes() const { return size_t(size.x * size.y * slices()); }
};

/// The part of a brick inside the volume, row by row: offset in the layer's bytes, offset in the brick, length.
template <class Visit>
void for_each_row(const Layer& layer, int64_t brick_x, int64_t brick_y, const Visit& visit)
{
    const int64_t width = std::min(SIDE, layer.size.x - brick_x * SIDE);
    const int64_t height = std::min(SIDE, layer.size.y - brick_y * SIDE);
    for (int64_t z = 0; z < layer.slices(); ++z)
        for (int64_t y = 0; y < height; ++y)
            visit(size_t(brick_x * SIDE + layer.size.x * (brick_y * SIDE + y + layer.size.y * z)),
                  size_t(SIDE * (y + SIDE * z)), size_t(width));
}

}  // namespace

void save_mask(const std::filesystem::path& path, const Mask& mask)
{
    const glm::i64vec3 counts = mask.brick_counts();
    AtomicWriter writer(path);
    std::vector<uint8_t> slab;
    for (int64_t bz = 0; bz < counts.z; ++bz) {
        const Layer layer{mask.size(), bz * SIDE};
        slab.assign(layer.bytes(), 0);
        for (int64_t by = 0; by < counts.y; ++by)
            for (int64_t bx = 0; bx < counts.x; ++bx) {
                const MaskBrick* brick = mask.brick(bx + counts.x * (by + counts.y * bz));
                if (!brick) continue;
                for_each_row(layer, bx, by, [&](size_t in_slab, size_t in_brick, size_t width) {
                    std::copy_n(brick->data() + in_brick, width, slab.data() + in_slab);
                });
            }
        writer.append(std::as_bytes(std::span(slab)));
    }
    writer.commit();
}

std::vector<MaskBrickChange> load_mask(const std::filesystem::path& path, const Size3& size)
{
    if (!std::filesystem::is_regular_file(path)) fail(path.string(), ": is not a regular file; expected a .mask file");
    const auto bytes = int64_t(std::filesystem::file_size(path));
    const int64_t voxels = size.x * size.y * size.z;
    if (bytes != voxels)
        fail(path.string(), ": holds ", bytes, " bytes; expected ", voxels, ", one for each voxel of ", size.x, " x ",
             size.y, " x ", size.z);
    std::ifstream file(path, std::ios::binary);
    const glm::i64vec3 counts = (size + Size3(SIDE - 1)) / Size3(SIDE);
    std::vector<MaskBrickChange> changes;
    std::vector<uint8_t> slab;
    for (int64_t bz = 0; bz < counts.z; ++bz) {
        const Layer layer{size, bz * SIDE};
        slab.resize(layer.bytes());
        file.read(reinterpret_cast<char*>(slab.data()), std::streamsize(slab.size()));
        if (!file) fail(path.string(), ": cannot be read to its end");
        for (int64_t by = 0; by < counts.y; ++by)
            for (int64_t bx = 0; bx < counts.x; ++bx) {
                MaskBrickChange change{.brick = bx + counts.x * (by + counts.y * bz), .runs = {}};
                for_each_row(layer, bx, by, [&](size_t in_slab, size_t in_brick, size_t width) {
                    for (size_t x = 0; x < width; ++x) {
                        const uint8_t group = slab[in_slab + x];
                        const auto voxel = uint16_t(in_brick + x);
                        if (group == 0) continue;
                        if (!change.runs.empty() && change.runs.back().last + 1 == voxel &&
                            change.runs.back().after == group)
                            ++change.runs.back().last;
                        else
                            change.runs.push_back({voxel, voxel, 0, group});
                    }
                });
                if (!change.runs.empty()) changes.push_back(std::move(change));
            }
    }
    return changes;
}

}  // namespace shvr

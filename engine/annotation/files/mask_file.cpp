#include "engine/annotation/files/mask_file.h"

#include <algorithm>
#include <map>
#include <utility>

#include "engine/annotation/files/voxel_strips.h"
#include "engine/base/atomic_writer.h"
#include "engine/volume/grid.h"

namespace shvr {

void save_mask(const std::filesystem::path& path, const Mask& mask, const Progress& progress)
{
    const glm::i64vec3 counts = mask.brick_counts();
    expect_space(path, bytes_of_voxels(mask.size(), 1), MORE_SPACE);
    AtomicWriter writer(path);
    std::vector<uint8_t> bytes;
    for_each_strip(mask.size(), [&](const VoxelStrip& strip) {
        bytes.assign(strip.voxels(), 0);
        const int64_t first_brick = counts.x * (strip.brick_y + counts.y * (strip.z / BRICK_SIDE));
        for (int64_t x = 0; x < counts.x; ++x) {
            const MaskBrick* brick = mask.brick(first_brick + x).get();
            if (!brick) continue;
            for_each_row(strip, x, [&](size_t in_strip, size_t in_brick, size_t width) {
                std::copy_n(brick->data() + in_brick, width, bytes.data() + in_strip);
            });
        }
        writer.append(std::as_bytes(std::span(bytes)));
        if (strip.ends_slice()) tell(progress, double(strip.z + 1) / double(mask.size().z));
    });
    writer.commit();
}

std::vector<MaskBrickChange> load_mask(const std::filesystem::path& path, const Size3& size)
{
    const FileDescriptor file = open_voxels(path, size, 1, ".mask");
    const glm::i64vec3 counts = (size + Size3(BRICK_SIDE - 1)) / Size3(BRICK_SIDE);
    std::vector<MaskBrickChange> changes;
    std::map<int64_t, std::vector<MaskRun>> layer;  // brick -> runs of painted voxels read so far
    std::vector<uint8_t> bytes;
    for_each_strip(size, [&](const VoxelStrip& strip) {
        bytes.resize(strip.voxels());
        read_next(file, path, std::as_writable_bytes(std::span(bytes)));
        const bool is_painted = std::any_of(bytes.begin(), bytes.end(), [](uint8_t group) { return group != 0; });
        for (int64_t x = 0; is_painted && x < counts.x; ++x)
            for_each_row(strip, x, [&](size_t in_strip, size_t in_brick, size_t width) {
                const auto row = std::span(bytes).subspan(in_strip, width);
                if (std::ranges::any_of(row, [](uint8_t group) { return group != 0; }))
                    append_painted_runs(layer[x + counts.x * strip.brick_y], row, in_brick);
            });
        if (!strip.ends_layer()) return;
        for (auto& [brick, runs] : layer) {
            runs.shrink_to_fit();
            changes.push_back({brick + counts.x * counts.y * (strip.z / BRICK_SIDE), std::move(runs)});
        }
        layer.clear();
    });
    return changes;
}

}  // namespace shvr

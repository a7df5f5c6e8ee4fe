#include "engine/live/region_query.h"

#include <cstring>
#include <utility>

#include "engine/passes/paint.h"
#include "engine/volume/grid.h"

namespace shvr {

namespace {

/// Limits of one frame: total size of its regions' labels, and number of regions, since each has its own buffers.
constexpr uint64_t LABEL_BYTES = uint64_t(32) << 20;
constexpr size_t MAX_REGIONS = 64;
/// Maximum total of bricks of a frame's regions, unless a single region needs more.
constexpr uint32_t MAX_BRICKS = 48;

gpu::RegionParams region_params(const RegionAt& asked, const PaintOp& op, uint32_t threshold_code)
{
    const BrushRegion& region = asked.region;
    const Size3 size = region.box.size();
    const auto words = uint32_t(region.words_per_row());
    const auto seed = [&] {
        if (op.brush != Brush::flood) return gpu::NO_SEED;
        const Size3 voxel(glm::floor(asked.centre_voxel)), at = voxel - region.box.lower;
        return region.contains(voxel) ? uint32_t(at.x + 32 * words * (at.y + size.y * at.z)) : gpu::NO_SEED;
    };
    return {.origin = glm::uvec3(region.box.lower),
            .size = glm::uvec3(size),
            .words_per_row = words,
            .threshold_code = threshold_code,
            .connectivity = uint32_t(op.connectivity),
            .seed = seed()};
}

Resource add_brush(FrameGraph& graph, const VolumeBinding& volume, Brush brush, const RegionInput& input)
{
    switch (brush) {
        case Brush::fill: return select_fill(graph, volume, input);
        case Brush::flood: return select_flood(graph, volume, input);
        case Brush::speckle: return select_speckles(graph, volume, input);
    }
    SHVR_CHECK(false, "brush ", int(brush));
}

VoxelBox box_around(std::span<const RegionAt> regions)
{
    VoxelBox box = regions.front().region.box;
    for (const RegionAt& at : regions) box = united(box, at.region.box);
    return box;
}

}  // namespace

FrameOfRegions frame_of_regions(const PaintOp& op, std::span<const glm::dvec3> positions, size_t first,
                                const VolumeInfo& volume)
{
    FrameOfRegions frame{.regions = {}, .end = first};
    VoxelBox around;
    uint64_t label_bytes = 0;
    for (; frame.end < positions.size() && label_bytes < LABEL_BYTES && frame.regions.size() < MAX_REGIONS;
         ++frame.end) {
        const glm::dvec3& position = positions[frame.end];
        BrushRegion region = make_region(op.region, position, op.radius_voxels, volume.spacing, volume.size);
        if (region.rows.empty() || region.words_per_row() == 0) continue;
        const VoxelBox both = frame.regions.empty() ? region.box : united(around, region.box);
        // All regions of a frame read the same bricks, which must fit at once.
        const glm::uvec3 bricks = bricks_around(both).counts;
        if (!frame.regions.empty() && both != around && bricks.x * bricks.y * bricks.z > MAX_BRICKS) break;
        around = both;
        label_bytes += uint64_t(region.words_per_row()) * 32 * region.rows.size() * sizeof(uint32_t);
        frame.regions.push_back({std::move(region), position});
    }
    return frame;
}

bool RegionQuery::ask(const PaintOp& op, std::vector<RegionAt> regions, Wait wait)
{
    SHVR_CHECK(!regions.empty());
    DeviceVolume& volume = renderer_.volume();
    const std::optional<RegionBricks> bricks = volume.region(box_around(regions), wait == Wait::for_bricks);
    if (!bricks) return false;
    const uint32_t threshold_code = volume.window().threshold_code(op.threshold);
    FrameGraph graph;
    const VolumeBinding atlas = volume.atlas(graph);
    for (const RegionAt& at : regions) {
        const gpu::RegionParams params = region_params(at, op, threshold_code);
        graph.read_back(add_brush(graph, atlas, op.brush, {params, *bricks, at.region.rows}), name_);
    }
    frame_ = renderer_.executor().submit(std::move(graph), {});
    regions_ = std::move(regions);
    return true;
}

std::vector<RegionAnswer> RegionQuery::answer()
{
    SHVR_CHECK(is_asking());
    const gpu::FrameResult result = std::exchange(frame_, {}).finish();
    gpu_ms_ = 0.0;
    for (const gpu::PassReport& pass : result.passes) gpu_ms_ += pass.gpu_ms;
    std::vector<RegionAnswer> answers;
    for (size_t i = 0; i < regions_.size(); ++i) {
        const std::vector<std::byte>& bytes = result.read_backs[i];
        std::vector<uint32_t> words(bytes.size() / sizeof(uint32_t));
        std::memcpy(words.data(), bytes.data(), bytes.size());
        answers.push_back({std::move(regions_[i].region), regions_[i].centre_voxel, std::move(words)});
    }
    regions_.clear();
    return answers;
}

}  // namespace shvr

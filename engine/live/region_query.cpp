#include "engine/live/region_query.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "engine/passes/paint.h"
#include "engine/volume/grid.h"

namespace shvr {

namespace {

/// Limits of one frame: total bytes of the regions' labels, and number of regions, since each has its own buffers.
constexpr uint64_t LABEL_BYTES = uint64_t(32) << 20;
constexpr size_t MAX_REGIONS = 64;
/// Maximum number of bricks for all regions of a frame together; exceeded only by a single region.
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

Resource add_brush(FrameGraph& graph, Brush brush, const gpu::RegionParams& params, std::span<const gpu::RowSpan> rows,
                   std::span<const uint32_t> bits)
{
    return brush == Brush::flood ? select_flood_in(graph, params, bits) : select_speckles_in(graph, params, rows, bits);
}

/// Clears the bits outside the region's rows.
void keep_rows(const BrushRegion& region, std::vector<uint32_t>& words)
{
    const auto per_row = int32_t(region.words_per_row());
    for (size_t row = 0; row < region.rows.size(); ++row)
        for (int32_t w = 0; w < per_row; ++w) {
            const int32_t begin = std::clamp(region.rows[row].begin - 32 * w, 0, 32);
            const int32_t end = std::clamp(region.rows[row].end - 32 * w, begin, 32);
            const auto within = uint32_t((uint64_t{1} << end) - (uint64_t{1} << begin));
            words[row * size_t(per_row) + size_t(w)] &= within;
        }
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
        // All regions of a frame read the same set of bricks, which must fit on the device at once.
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
    drop();
    if (ThresholdBricks* const bricks = renderer_.scene().threshold_bricks())
        return ask_host(*bricks, op, std::move(regions), wait);
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

bool RegionQuery::ask_host(ThresholdBricks& bricks, const PaintOp& op, std::vector<RegionAt>&& regions, Wait wait)
{
    if (wait == Wait::no && !bricks.get_ready(box_around(regions), op.threshold)) return false;
    FrameGraph graph;
    std::vector<std::vector<uint32_t>> bits;
    for (const RegionAt& at : regions) {
        bits.push_back(bricks.bits_in(at.region.box, op.threshold));
        keep_rows(at.region, bits.back());
        if (op.brush != Brush::fill)
            graph.read_back(add_brush(graph, op.brush, region_params(at, op, 0), at.region.rows, bits.back()), name_);
    }
    if (op.brush == Brush::fill) {
        for (size_t i = 0; i < regions.size(); ++i)
            known_.push_back({std::move(regions[i].region), regions[i].centre_voxel, std::move(bits[i])});
        return true;
    }
    frame_ = renderer_.executor().submit(std::move(graph), {});
    regions_ = std::move(regions);
    return true;
}

std::vector<RegionAnswer> RegionQuery::answer()
{
    SHVR_CHECK(is_asking());
    if (!known_.empty()) {
        gpu_ms_ = 0.0;
        return std::exchange(known_, {});
    }
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

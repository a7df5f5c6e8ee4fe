#include "engine/live/relevance.h"

#include <cmath>
#include <cstring>
#include <utility>

#include "engine/passes/paint.h"

namespace shvr {

namespace {

/// The cube around a voxel; a cube that would reach over the border is moved inside, so that it is as large as can be.
BrushRegion cube_around(const glm::dvec3& voxel, const Size3& volume_size)
{
    for (int axis = 0; axis < 3; ++axis)
        if (!std::isfinite(voxel[axis])) fail("the probe's place along ", "xyz"[axis], " is ", voxel[axis]);
    const Size3 size = glm::min(volume_size, Size3(Relevance::SIDE));
    const glm::dvec3 lower =
        glm::clamp(glm::round(voxel - 0.5 * glm::dvec3(size)), glm::dvec3(0.0), glm::dvec3(volume_size - size));
    BrushRegion region;
    region.box = {Size3(lower), Size3(lower) + size};
    region.rows.assign(size_t(size.y * size.z), {0, int32_t(size.x)});
    return region;
}

}  // namespace

void Relevance::ask(const glm::dvec3& voxel, double threshold, uint64_t now_ns)
{
    BrushRegion region = cube_around(voxel, renderer_.volume().info().size);
    const std::optional<RegionBricks> bricks = renderer_.volume().region(region.box, false);
    if (!bricks) return;  // on their way; whoever feels fades out with the old answer's age
    region_ = std::move(region);
    asked_ns_ = now_ns;
    FrameGraph graph;
    const VolumeBinding volume = renderer_.volume().atlas(graph);
    const gpu::RegionParams params{.origin = glm::uvec3(region_.box.lower),
                                   .size = glm::uvec3(region_.box.size()),
                                   .words_per_row = uint32_t(region_.words_per_row()),
                                   .threshold_code = renderer_.volume().window().threshold_code(threshold),
                                   .connectivity = 6,
                                   .seed = gpu::NO_SEED};
    graph.read_back(select_fill(graph, volume, {params, *bricks, region_.rows}), "mirror relevance");
    answer_ = renderer_.executor().submit(std::move(graph));
}

std::optional<RelevanceBits> Relevance::take()
{
    if (!answer_ || !answer_.done()) return std::nullopt;
    const gpu::FrameResult result = answer_.finish();
    RelevanceBits bits{
        .box = region_.box, .words_per_row = region_.words_per_row(), .words = {}, .asked_ns = asked_ns_};
    bits.words.resize(result.read_backs[0].size() / sizeof(uint32_t));
    std::memcpy(bits.words.data(), result.read_backs[0].data(), result.read_backs[0].size());
    for (const gpu::PassReport& pass : result.passes) bits.gpu_ms += pass.gpu_ms;
    return bits;
}

}  // namespace shvr

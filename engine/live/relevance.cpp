#include "engine/live/relevance.h"

#include <utility>

#include "engine/live/relevance_host.h"

namespace shvr {

namespace {

BrushRegion region_of(const VoxelBox& box)
{
    BrushRegion region;
    region.box = box;
    const Size3 size = box.size();
    region.rows.assign(size_t(size.y * size.z), {0, int32_t(size.x)});
    return region;
}

}  // namespace

void Relevance::ask(const glm::dvec3& voxel, double threshold, uint64_t now_ns)
{
    ask(relevance_cube(voxel, renderer_.volume().info().size, SIDE), threshold, now_ns);
}

void Relevance::ask(const VoxelBox& box, double threshold, uint64_t now_ns)
{
    const PaintOp fill{.brush = Brush::fill, .threshold = threshold};
    const glm::dvec3 middle = 0.5 * glm::dvec3(box.lower + box.upper);
    // If bricks are still being loaded, nothing is asked; the host computes the bits (relevance_mirror.h).
    if (query_.ask(fill, {{region_of(box), middle}}, RegionQuery::Wait::no)) asked_ns_ = now_ns;
}

std::optional<RelevanceBits> Relevance::take()
{
    if (!query_.is_answered()) return std::nullopt;
    RegionAnswer answer = std::move(query_.answer().front());
    return RelevanceBits{.box = answer.region.box,
                         .words_per_row = answer.region.words_per_row(),
                         .words = std::move(answer.words),
                         .asked_ns = asked_ns_,
                         .gpu_ms = query_.gpu_ms(),
                         .level = 0};
}

}  // namespace shvr

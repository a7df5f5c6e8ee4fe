#include "engine/live/relevance.h"

#include <utility>

#include "engine/live/relevance_host.h"

namespace shvr {

namespace {

BrushRegion cube_around(const glm::dvec3& voxel, const Size3& volume_size)
{
    BrushRegion region;
    region.box = relevance_cube(voxel, volume_size, Relevance::SIDE);
    const Size3 size = region.box.size();
    region.rows.assign(size_t(size.y * size.z), {0, int32_t(size.x)});
    return region;
}

}  // namespace

void Relevance::ask(const glm::dvec3& voxel, double threshold, uint64_t now_ns)
{
    const PaintOp fill{.brush = Brush::fill, .threshold = threshold};
    // While bricks are being loaded, the servo fades the force as the last answer ages.
    if (query_.ask(fill, {{cube_around(voxel, renderer_.volume().info().size), voxel}}, RegionQuery::Wait::no))
        asked_ns_ = now_ns;
}

std::optional<RelevanceBits> Relevance::take()
{
    if (!query_.is_answered()) return std::nullopt;
    RegionAnswer answer = std::move(query_.answer().front());
    return RelevanceBits{.box = answer.region.box,
                         .words_per_row = answer.region.words_per_row(),
                         .words = std::move(answer.words),
                         .asked_ns = asked_ns_,
                         .gpu_ms = query_.gpu_ms()};
}

}  // namespace shvr

#include "engine/live/relevance.h"

#include <cmath>
#include <utility>

namespace shvr {

namespace {

/// The cube around a voxel, shifted inside the volume at its borders, so that it is as large as possible.
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

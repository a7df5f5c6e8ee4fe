#include "engine/live/probe_meter.h"

#include <array>
#include <bit>
#include <utility>

namespace shvr {

namespace {

std::optional<double> share_of(const RegionAnswer& answer)
{
    int64_t inside = 0, relevant = 0;
    for (const gpu::RowSpan& row : answer.region.rows) inside += std::max(row.end - row.begin, 0);
    for (const uint32_t word : answer.words) relevant += std::popcount(word);
    return inside > 0 ? std::optional(double(relevant) / double(inside)) : std::nullopt;
}

}  // namespace

bool ProbeMeter::is_current() const
{
    return !wanted_ || answered_ == Asked{*wanted_, annotator_.revision()};
}

void ProbeMeter::advance()
{
    if (query_.is_asking()) {
        if (!query_.is_answered()) return;
        share_ = share_of(query_.answer().front());
        answered_ = std::exchange(asked_, {});
    }
    if (is_current()) return;
    const Asked now{*wanted_, annotator_.revision()};
    const PaintOp fill{.brush = Brush::fill,
                       .region = RegionShape::ball,
                       .threshold = now.ball.threshold,
                       .radius_voxels = now.ball.radius_voxels};
    FrameOfRegions frame = frame_of_regions(fill, std::array{now.ball.voxel}, 0, annotator_.renderer().volume().info());
    if (frame.regions.empty()) {
        share_.reset();  // the ball is outside the volume
        answered_ = now;
    } else if (query_.ask(fill, std::move(frame.regions), RegionQuery::Wait::no)) {
        asked_ = now;
    }
}

}  // namespace shvr

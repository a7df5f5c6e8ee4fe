#include "engine/live/previewer.h"

#include <utility>

namespace shvr {

PaintOp dab_of(const Session& session, const VolumeInfo& volume, const VolumeStatistics& statistics)
{
    return stroke_of(session.probe.brush, automatic_threshold(session.transfer_function, statistics),
                     {session.probe.voxel.value_or(0.5 * glm::dvec3(volume.size))});
}

void choose_thresholds(Session& session, const VolumeInfo& volume, const VolumeStatistics& statistics)
{
    ProbeSettings& probe = session.probe;
    if (!probe.brush.threshold) probe.brush.threshold = dab_of(session, volume, statistics).threshold;
    if (!probe.haptic_threshold) probe.haptic_threshold = probe.brush.threshold;
}

std::optional<ProbeLook> shown_probe(const Session& session, Renderer& renderer, Annotator& annotator)
{
    const VolumeInfo& volume = renderer.volume().info();
    std::optional<ProbeLook> look = shown_probe(session, volume, renderer.statistics());
    if (look && session.probe.preview.value_or(false))
        look->preview = std::make_shared<PaintPreview>(
            annotator.preview(in_session(dab_of(session, volume, renderer.statistics()), session)));
    return look;
}

void Previewer::want(const std::optional<PaintOp>& brush)
{
    if (wanted_ == brush) return;
    wanted_ = brush;
    // Checked after the copy: if checked before, g++ 14 wrongly warns that the copy reads beyond the end of the path.
    SHVR_CHECK(!wanted_ || wanted_->path.size() == 1);
    if (!wanted_) shown_.reset();
}

bool Previewer::is_current() const
{
    return wanted_ ? answered_ == Asked{*wanted_, annotator_.revision()} : shown_ == nullptr;
}

void Previewer::drop()
{
    query_.drop();
    asked_.reset();
}

void Previewer::advance()
{
    if (query_.is_asking()) {
        if (!query_.is_answered()) return;
        const std::vector<RegionAnswer> answers = query_.answer();
        if (wanted_) shown_ = std::make_shared<PaintPreview>(annotator_.preview(asked_->brush, answers));
        answered_ = std::exchange(asked_, {});
    }
    if (!wanted_) answered_.reset();
    if (!wanted_ || is_current()) return;
    const Asked now{*wanted_, annotator_.revision()};
    FrameOfRegions frame = frame_of_regions(*wanted_, wanted_->path, 0, annotator_.renderer().volume().info());
    if (frame.regions.empty()) {
        shown_ = std::make_shared<PaintPreview>();  // the brush is outside the volume
        answered_ = now;
    } else if (query_.ask(*wanted_, std::move(frame.regions), RegionQuery::Wait::no)) {
        asked_ = now;
    }
}

}  // namespace shvr

#include "engine/live/previewer.h"

#include <utility>

namespace shvr {

PaintOp dab_of(const Session& session, const VolumeInfo& volume, const VolumeStatistics& statistics)
{
    return stroke_of(session.probe.brush, automatic_threshold(session.transfer_function, statistics),
                     {session.probe.voxel.value_or(0.5 * glm::dvec3(volume.size))});
}

std::optional<ProbeLook> shown_probe(const Session& session, Renderer& renderer, Annotator& annotator)
{
    const VolumeInfo& volume = renderer.volume().info();
    std::optional<ProbeLook> look = shown_probe(session, volume, renderer.statistics());
    if (look && session.probe.preview)
        look->preview = std::make_shared<PaintPreview>(
            annotator.preview(with_offset(dab_of(session, volume, renderer.statistics()), session.transfer_function)));
    return look;
}

PaintPreview Annotator::preview_with(const PaintOp& op, const Answered& answered) const
{
    const bool erases = op.paints_group && op.group == 0;
    const PaintPreview::Kind kind = erases            ? PaintPreview::Kind::erase
                                    : op.paints_group ? PaintPreview::Kind::group
                                                      : PaintPreview::Kind::density;
    return preview_of(changes_of(op, answered), document().mask.size(), kind);
}

PaintPreview Annotator::preview(const PaintOp& op)
{
    return preview_with(op, ask(op));
}

void Previewer::want(const std::optional<PaintOp>& brush)
{
    SHVR_CHECK(!brush || brush->path.size() == 1);
    if (wanted_ == brush) return;
    wanted_ = brush;
    if (!wanted_) shown_.reset();
}

bool Previewer::is_current() const
{
    return wanted_ ? answered_ == Asked{*wanted_, annotator_.revision()} : shown_ == nullptr;
}

void Previewer::advance()
{
    if (answer_) {
        if (!answer_.done()) return;
        const gpu::FrameResult result = std::exchange(answer_, {}).finish();
        Annotator::Answered answered = annotator_.nothing_yet(asked_->brush);
        Annotator::add(answered, asked_->brush, regions_, result);
        if (wanted_) shown_ = std::make_shared<PaintPreview>(annotator_.preview_with(asked_->brush, answered));
        answered_ = std::exchange(asked_, {});
    }
    if (!wanted_) answered_.reset();
    if (!wanted_ || is_current()) return;
    size_t next = 0;
    std::optional<Annotator::Batch> batch = annotator_.make_batch(*wanted_, wanted_->path, next, false);
    if (!batch) return;  // its bricks are on their way
    regions_ = std::move(batch->regions);
    asked_ = {*wanted_, annotator_.revision()};
    if (!regions_.empty()) {
        answer_ = annotator_.renderer_.executor().submit(std::move(batch->graph), {.timestamps = false});
        return;
    }
    shown_ = std::make_shared<PaintPreview>();  // the brush is outside the volume
    answered_ = std::exchange(asked_, {});
}

}  // namespace shvr

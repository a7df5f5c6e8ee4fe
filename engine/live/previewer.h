#pragma once
// Keeps the exact preview of a brush up to date while the user moves it: the records that painting would make, without
// painting. One query is in flight at a time and nothing waits, so during motion the preview lags by one answer; at
// rest it is exact. Submits nothing while no preview is wanted. One thread, the annotator's.

#include <memory>

#include "engine/annotation/work/paint_preview.h"
#include "engine/live/annotator.h"

namespace shvr {

/// The brush of a session's probe, for one dab at the probe's position. Unset settings get defaults for the volume,
/// except an automatic offset, which `in_session` resolves as it applies the locks.
PaintOp dab_of(const Session& session, const VolumeInfo& volume, const VolumeStatistics& statistics);
/// Chooses default thresholds of the probe for the volume if they are unset. Saved sessions always contain them, so
/// every function that saves calls this.
void choose_thresholds(Session& session, const VolumeInfo& volume, const VolumeStatistics& statistics);
/// How pictures of a session show its probe, including its brush's preview. Waits for the device.
std::optional<ProbeLook> shown_probe(const Session& session, Renderer& renderer, Annotator& annotator);

class Previewer {
public:
    explicit Previewer(Annotator& annotator) : annotator_(annotator), query_(annotator.renderer()) {}

    /// Sets the wanted preview: one dab of `brush` at the single position of its path, as `in_session` makes it; null:
    /// none. Call it in every frame: it only compares while nothing has changed.
    void want(const std::optional<PaintOp>& brush);
    /// Collects a finished answer and submits the next query.
    void advance();
    /// Drops a query in flight; it is submitted again.
    void drop();

    /// The newest answer; null if none is wanted or the first has not arrived.
    const std::shared_ptr<const PaintPreview>& shown() const { return shown_; }
    /// Whether shown() is for the wanted brush and the current paint.
    bool is_current() const;

private:
    /// The inputs of an answer.
    struct Asked {
        PaintOp brush;
        uint64_t revision = 0;  ///< revision of the paint
        bool operator==(const Asked&) const = default;
    };

    Annotator& annotator_;
    std::optional<PaintOp> wanted_;
    std::optional<Asked> asked_, answered_;
    RegionQuery query_;
    std::shared_ptr<const PaintPreview> shown_;
};

}  // namespace shvr

#pragma once
// Keeps the exact preview of a brush up to date while the user moves it: the records that painting would make, without
// painting. One query is in flight at a time and no call waits, so the preview lags by one answer while the brush
// moves, and is exact at rest. Submits nothing while no preview is wanted. Used only by the annotator's thread.

#include <memory>

#include "engine/annotation/work/paint_preview.h"
#include "engine/live/annotator.h"

namespace shvr {

/// Returns the brush of a session's probe, for one dab at the probe's position. Unset settings get the volume's
/// defaults; only an automatic offset stays unresolved: `in_session` replaces it and adds the locked groups.
PaintOp dab_of(const Session& session, const VolumeInfo& volume, const VolumeStatistics& statistics);
/// Sets the probe's unset thresholds to the volume's defaults. Saved sessions always contain thresholds, so every
/// function that saves a session calls this one first.
void choose_thresholds(Session& session, const VolumeInfo& volume, const VolumeStatistics& statistics);
/// Returns how pictures of a session show its probe, including the brush's preview. Waits for the device.
std::optional<ProbeLook> shown_probe(const Session& session, Renderer& renderer, Annotator& annotator);

class Previewer {
public:
    explicit Previewer(Annotator& annotator) : annotator_(annotator), query_(annotator.renderer()) {}

    /// Sets the wanted preview: one dab of `brush`, as returned by `in_session`, at the single position of its path.
    /// Null: no preview. Call it in every frame: without a change, the call only compares.
    void want(const std::optional<PaintOp>& brush);
    /// Collects a finished answer and submits the next query.
    void advance();
    /// Drops a query in flight; `advance` then submits it again.
    void drop();

    /// The newest answer; null if no preview is wanted, or before the first answer.
    const std::shared_ptr<const PaintPreview>& shown() const { return shown_; }
    /// Whether shown() is the preview of the wanted brush with the current paint.
    bool is_current() const;

private:
    /// The inputs of an answer.
    struct Asked {
        PaintOp brush;
        uint64_t revision = 0;  ///< revision of the paint on which the preview is based
        bool operator==(const Asked&) const = default;
    };

    Annotator& annotator_;
    std::optional<PaintOp> wanted_;
    std::optional<Asked> asked_, answered_;
    RegionQuery query_;
    std::shared_ptr<const PaintPreview> shown_;
};

}  // namespace shvr

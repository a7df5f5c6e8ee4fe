#pragma once
// Keeps the exact preview of a brush up to date while the user moves it: the records that painting would make, without
// painting. One query is in flight at a time and nothing waits, so during motion the preview lags by one answer; at
// rest it is exact. Submits nothing where no preview is wanted. One thread, the annotator's.

#include <memory>

#include "engine/annotation/work/paint_preview.h"
#include "engine/live/annotator.h"

namespace shvr {

/// The brush of a session's probe, for one dab at the probe's position. Missing settings are chosen for the volume,
/// except an automatic offset; `in_session` gives it that, and the locks.
PaintOp dab_of(const Session& session, const VolumeInfo& volume, const VolumeStatistics& statistics);
/// The probe's thresholds that are not given are chosen for the volume. What is kept of a session has them, whoever
/// keeps it.
void choose_thresholds(Session& session, const VolumeInfo& volume, const VolumeStatistics& statistics);
/// What pictures of a session show of its probe, its brush's preview included. Waits for the device.
std::optional<ProbeLook> shown_probe(const Session& session, Renderer& renderer, Annotator& annotator);

class Previewer {
public:
    explicit Previewer(Annotator& annotator) : annotator_(annotator), query_(annotator.renderer()) {}

    /// Sets the wanted preview: of one dab of `brush` at the single position of its path, as `in_session` makes
    /// it; null: none. Call it in every frame: it costs a comparison where nothing has changed.
    void want(const std::optional<PaintOp>& brush);
    /// Collects a finished answer and submits the next query.
    void advance();
    /// Forgets a query that is in flight; it is asked again.
    void drop();

    /// The newest answer; null where none is wanted or the first has not arrived.
    const std::shared_ptr<const PaintPreview>& shown() const { return shown_; }
    /// Whether it is for the wanted brush and the present paint.
    bool is_current() const;

private:
    /// What an answer depends on.
    struct Asked {
        PaintOp brush;
        uint64_t revision = 0;  ///< of the paint
        bool operator==(const Asked&) const = default;
    };

    Annotator& annotator_;
    std::optional<PaintOp> wanted_;
    std::optional<Asked> asked_, answered_;
    RegionQuery query_;
    std::shared_ptr<const PaintPreview> shown_;
};

}  // namespace shvr

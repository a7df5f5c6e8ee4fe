#pragma once
// Keeps the exact preview of a brush up to date while a hand moves it: the records that painting would make, not
// carried out. One query is in flight at a time and nothing waits, so while the hand moves the preview lags by the time
// of an answer; at rest it is exact. Where no preview is wanted nothing is asked. One thread, the annotator's.

#include <memory>

#include "engine/annotation/work/paint_preview.h"
#include "engine/live/annotator.h"

namespace shvr {

/// The brush of a session's probe, for a dab where it is; what is not given is chosen for the volume, but for an
/// automatic offset (with_offset).
PaintOp dab_of(const Session& session, const VolumeInfo& volume, const VolumeStatistics& statistics);
/// What pictures of a session show of its probe, its brush's preview included. Waits for the device.
std::optional<ProbeLook> shown_probe(const Session& session, Renderer& renderer, Annotator& annotator);

class Previewer {
public:
    explicit Previewer(Annotator& annotator) : annotator_(annotator), query_(annotator.renderer()) {}

    /// From now on, the preview of a dab of `brush` at its path's one position, with its offset chosen (with_offset);
    /// nothing: none. Call it in every frame: it costs a comparison where nothing has changed.
    void want(const std::optional<PaintOp>& brush);
    /// Collects a finished answer and submits the next query.
    void advance();

    /// The newest answer; null where none is wanted or the first is not there yet.
    const std::shared_ptr<const PaintPreview>& shown() const { return shown_; }
    /// It is of the wanted brush and of what is painted now.
    bool is_current() const;

private:
    /// What an answer depends on.
    struct Asked {
        PaintOp brush;
        uint64_t revision = 0;  ///< of what is painted
        bool operator==(const Asked&) const = default;
    };

    Annotator& annotator_;
    std::optional<PaintOp> wanted_;
    std::optional<Asked> asked_, answered_;
    RegionQuery query_;
    std::shared_ptr<const PaintPreview> shown_;
};

}  // namespace shvr

#pragma once
// Keeps the exact preview of a brush up to date while a hand moves it: the annotator's own question to the device and its
// own records, which are not carried out. One question is on its way at a time and nothing waits, so while the hand moves
// the preview lags by what an answer takes; at rest it is exact. Where none is wanted nothing is asked. One thread, the
// annotator's.

#include <memory>

#include "engine/annotation/work/paint_preview.h"
#include "engine/live/annotator.h"

namespace shvr {

/// The brush of a session's probe, for a dab where it is; what is not given is chosen for the volume, but for an automatic
/// offset (with_offset).
PaintOp dab_of(const Session& session, const VolumeInfo& volume, const VolumeStatistics& statistics);
/// What pictures of a session show of its probe, its brush's preview included. Waits for the device.
std::optional<ProbeLook> shown_probe(const Session& session, Renderer& renderer, Annotator& annotator);

class Previewer {
public:
    explicit Previewer(Annotator& annotator) : annotator_(annotator) {}

    /// From now on, the preview of a dab of `brush` at its path's one position, with an offset that is chosen (with_offset);
    /// nothing: none. To be called at every turn: it costs a comparison where all is as before.
    void want(const std::optional<PaintOp>& brush);
    /// Takes the device's answer, if it is there, and asks what is asked next.
    void advance();

    /// The newest answer; null where none is wanted or the first is on its way.
    const std::shared_ptr<const PaintPreview>& shown() const { return shown_; }
    /// It is of what is wanted, and of what is painted now.
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
    std::vector<Annotator::Asked> regions_;
    gpu::Submission answer_;
    std::shared_ptr<const PaintPreview> shown_;
};

}  // namespace shvr

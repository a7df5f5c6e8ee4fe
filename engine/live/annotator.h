#pragma once
// Carries out annotation commands: asks the device which voxels a brush selects, records the result in the history and
// uploads the changed voxels. Scripts, keys, menus and the stylus all go through here.
//
//   PaintOp -> positions along the stroke -> RegionQuery (device) -> VoxelSelection -> records -> Work -> device
//
// The device says what a brush selects; which of that changes is decided where the records are made (painting.h).
//
// A script paints a whole stroke and waits. A user begins a stroke, extends it and ends it; it is painted as the device
// answers, as one command however many answers that takes. One thread, the renderer's.

#include <deque>
#include <memory>
#include <optional>

#include "engine/annotation/stroke_result.h"
#include "engine/annotation/work/paint_preview.h"
#include "engine/annotation/work/work.h"
#include "engine/live/region_query.h"
#include "engine/session/session.h"

namespace shvr {

/// `op` as a session has it painted: with a number in place of an automatic offset, and with the groups that are
/// locked. Everything that is painted or previewed for a person comes through here.
PaintOp in_session(PaintOp op, const Session& session);

/// The files in which a session keeps its work.
WorkFiles work_files(const Session& session, const VolumeInfo& volume);
/// And the lasting settings of an `OpenedSession`, but for those that the "key=value" settings in `overridden` set this
/// time only.
WorkFiles work_files(const Session& session, const VolumeInfo& volume, const std::vector<std::string>& overridden);
/// The kept settings, too, for callers that take Work::kept_settings() and tell Work::keep_settings what has changed.
WorkFiles with_kept_settings(WorkFiles files, const Session& session, const std::vector<std::string>& overridden);

class Annotator {
public:
    /// So often what failed for want of memory is tried: with the pauses of a person's window, for 5 s.
    static constexpr int MOST_TRIES = 20;

    /// The volume must be loaded; the mask starts unpainted.
    explicit Annotator(Renderer& renderer);
    /// Goes on with work that is open, perhaps on another thread until now. The caller lets the scene show it.
    Annotator(Renderer& renderer, std::unique_ptr<Work> work);

    /// For saving, file names and the trace's selection. Use the functions below to change annotations, so that the
    /// device shows the change. Where it cannot, for want of memory, they do not fail: `is_behind`.
    Work& work() { return *work_; }
    const Work& work() const { return *work_; }
    /// For another annotator; this one is of no use any more.
    std::unique_ptr<Work> take_work() { return std::move(work_); }
    const Document& document() const { return work_->document(); }
    const History& history() const { return work_->history(); }
    Renderer& renderer() const { return renderer_; }
    /// Counts the changes of groups and offsets.
    uint64_t revision() const { return revision_; }

    /// As Work::open and Work::choose; also update the device.
    std::vector<Notice> open(const WorkFiles& files, const Work::Opening& opening = {});
    std::vector<Notice> choose(Belief belief);

    /// The voxels that `op` selects, whatever their group.
    VoxelSelection select(const PaintOp& op);
    /// The exact preview: the voxels that paint(op) would change now. Paints nothing and waits; Previewer
    /// (engine/live/previewer.h) does not.
    PaintPreview preview(const PaintOp& op);
    /// The same, from the device's answers for all regions of `op`.
    PaintPreview preview(const PaintOp& op, std::span<const RegionAnswer> answers) const;
    /// Paints, as one command. Returns how many voxels changed their group plus how many changed their offset;
    /// `last_stroke` says more. All regions of a stroke see the volume as it was before it.
    int64_t paint(const PaintOp& op);

    /// Begins a stroke by hand; ignores `brush.path`. Does not wait: `advance` paints. Later regions may see offsets
    /// that earlier ones have painted. The locks are those of `brush` to the stroke's end. Strokes that have ended and
    /// are not painted yet are painted first, in order: a hand need not wait for the device.
    void begin_stroke(const PaintOp& brush);
    void extend_stroke(const glm::dvec3& voxel);
    /// The next position is not joined to the last one: nothing is painted in between.
    void lift_stroke()
    {
        if (stroke_is_open()) strokes_.back().last.reset();
    }
    void end_stroke();
    /// A stroke is open, or part of one has not been painted yet.
    bool stroke_is_running() const { return !strokes_.empty(); }
    /// The last stroke has begun and not ended.
    bool stroke_is_open() const { return !strokes_.empty() && !strokes_.back().has_ended; }
    /// Ends all at once: what is painted stays, the rest is dropped.
    void drop_strokes();
    /// Asks the device again for what it has not answered yet: it has been started again.
    void drop_queries();
    /// Shows what memory was too short for, paints a finished answer of the first stroke and submits the next query.
    /// Returns the voxels that may look different. Where the driver has too little memory it fails with a MemoryError
    /// and goes on when it is called again, up to MOST_TRIES times on end; where a stroke cannot go on (that, a brush
    /// that is too large, or bricks or the journal fail), it fails with another, drops the rest of it, and says so.
    std::optional<VoxelBox> advance();
    /// What is painted is not shown as it is: `advance` tries it.
    bool is_behind() const { return renderer_.scene().is_behind() && tries_to_show_ < MOST_TRIES; }
    /// Tries it at once; fails where it cannot.
    void catch_up();
    /// Counts the strokes by hand that are painted to their end.
    uint64_t strokes_done() const { return strokes_done_; }
    /// What the last finished stroke did, by hand or by `paint`.
    const StrokeResult& last_stroke() const { return last_stroke_; }

    /// Applies changes made by trace_edit.h as one command; not while a stroke is running. Returns the command, valid
    /// until the history changes; null where `changes` is empty.
    const Command* edit_trace(std::string label, std::vector<TraceChange> changes);

    /// Applies changes that fit as one command; not while a stroke is running. Null where there are none.
    const Command* perform(std::string label, std::vector<Change> changes);

    /// As Work::change_settings; not while a stroke is running. The session is the caller's.
    const Command* change_settings(std::string label, const SettingValues& values);

    /// The command undone or redone; null where there is none left, or a stroke is running.
    const Command* undo();
    const Command* redo();
    /// As Work::revert; null also while a stroke is running.
    const Command* revert();

private:
    /// Accumulates the answers of a stroke.
    struct Answered {
        VoxelSelection selection;
        std::optional<DensityStroke> density;  ///< where the brush paints offsets
    };
    struct Stroke {
        PaintOp brush;
        RegionQuery query;
        std::vector<glm::dvec3> positions{};  ///< regions for those from `next` on have not been painted yet
        size_t next = 0;
        size_t asked_to = 0;               ///< the end of those in the query
        std::optional<glm::dvec3> last{};  ///< the last position of the hand
        bool has_ended = false;
        bool is_recorded = false;  ///< the last command of the history is this stroke's
        StrokeTally tally{brush};
        StrokeResult result = tally.result();  ///< of what is painted
        int failed_tries = 0;                  ///< on end
    };
    /// The records of an answer.
    struct Records {
        std::vector<MaskBrickChange> groups{};
        std::vector<DensityBrickChange> offsets{};
    };
    Answered nothing_yet(const PaintOp& op) const;
    static void add(Answered& answered, const PaintOp& op, std::span<const RegionAnswer> answers);
    Answered ask(const PaintOp& op);
    Records records_of(const PaintOp& op, const Answered& answered) const;
    static std::vector<Change> changes_of(Records records);
    std::optional<VoxelBox> advance_first_stroke();
    std::optional<VoxelBox> advance_stroke();
    void drop_first_stroke();
    PaintPreview preview_of_answer(const PaintOp& op, const Answered& answered) const;
    std::optional<VoxelBox> paint_answer();
    void show(const Touched& touched, const std::optional<VoxelBox>& within = {});
    void show(const Command& command);
    template <class Update>
    void try_to_show(const Update& update);

    Renderer& renderer_;
    std::deque<Stroke> strokes_;  ///< the first is being painted; the last alone may be open
    uint64_t strokes_done_ = 0;
    StrokeResult last_stroke_;
    uint64_t revision_ = 0;
    int tries_to_show_ = 0;  ///< since the last change
    std::unique_ptr<Work> work_;
};

}  // namespace shvr

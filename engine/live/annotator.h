#pragma once
// Executes annotation commands: asks the device which voxels a brush selects, records the result in the history and
// uploads the changed voxels. Scripts, keys, menus and the stylus all go through here.
//
//   PaintOp -> positions along the stroke -> RegionQuery (device) -> VoxelSelection -> records -> Work -> device
//
// The device decides what a brush selects; which of these voxels change is decided where the records are made
// (painting.h).
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

/// `op` as painted in a session: with an automatic offset replaced by a number, and with the session's locked groups.
/// Everything that is painted or previewed for a user passes through here.
PaintOp in_session(PaintOp op, const Session& session);

/// The files in which a session stores its work.
WorkFiles work_files(const Session& session, const VolumeInfo& volume);
/// Likewise, with the lasting settings of an `OpenedSession`, except those that `overridden` ("key=value") sets for
/// this run only.
WorkFiles work_files(const Session& session, const VolumeInfo& volume, const std::vector<std::string>& overridden);
/// Adds the kept settings, for callers that apply Work::kept_settings() and report changes to Work::keep_settings.
WorkFiles with_kept_settings(WorkFiles files, const Session& session, const std::vector<std::string>& overridden);

class Annotator {
public:
    /// Number of attempts after running out of memory: about 5 s, given the pauses of a user's window.
    static constexpr int MAX_TRIES = 20;

    /// The volume must be loaded; the mask starts unpainted.
    explicit Annotator(Renderer& renderer);
    /// Continues open work, which another thread may have used before. The caller must make the scene show it.
    Annotator(Renderer& renderer, std::unique_ptr<Work> work);

    /// For saving, file names and the trace's selection. To change annotations, use the functions below, which show the
    /// change on the device. If that is impossible for lack of memory, they do not fail: see `is_behind`.
    Work& work() { return *work_; }
    const Work& work() const { return *work_; }
    /// Releases the work for another annotator; this one must not be used any more.
    std::unique_ptr<Work> take_work() { return std::move(work_); }
    const Document& document() const { return work_->document(); }
    const History& history() const { return work_->history(); }
    Renderer& renderer() const { return renderer_; }
    /// Incremented by changes of groups and offsets.
    uint64_t revision() const { return revision_; }

    /// As Work::open and Work::choose; these also update the device.
    std::vector<Notice> open(const WorkFiles& files, const Work::Opening& opening = {});
    std::vector<Notice> choose(Belief belief);

    /// The voxels that `op` selects, whatever their group.
    VoxelSelection select(const PaintOp& op);
    /// The exact preview: the voxels that paint(op) would change now. Paints nothing, but waits; Previewer
    /// (engine/live/previewer.h) does not.
    PaintPreview preview(const PaintOp& op);
    /// Likewise, from the device's answers for all regions of `op`.
    PaintPreview preview(const PaintOp& op, std::span<const RegionAnswer> answers) const;
    /// Paints, as one command. Returns how many voxels changed their group plus how many changed their offset;
    /// `last_stroke` has details. All regions of a stroke see the volume as it was before it.
    int64_t paint(const PaintOp& op);

    /// Begins an interactive stroke; ignores `brush.path`. Does not wait: `advance` paints. Later regions may see
    /// offsets that earlier ones have painted. The locks of `brush` apply until the stroke ends. Strokes that have
    /// ended and are not painted yet are painted first, in order: the user need not wait for the device.
    void begin_stroke(const PaintOp& brush);
    void extend_stroke(const glm::dvec3& voxel);
    /// Interrupts the stroke: nothing is painted between the last position and the next one.
    void lift_stroke()
    {
        if (stroke_is_open()) strokes_.back().last.reset();
    }
    void end_stroke();
    /// Whether a stroke is open, or part of one has not been painted yet.
    bool stroke_is_running() const { return !strokes_.empty(); }
    /// Whether the last stroke has begun and has not ended.
    bool stroke_is_open() const { return !strokes_.empty() && !strokes_.back().has_ended; }
    /// Ends all strokes at once: painted parts stay, the rest is dropped.
    void drop_strokes();
    /// Repeats the queries that the device has not answered, after it was restarted.
    void drop_queries();
    /// Shows changes for which memory was too short, paints a finished answer of the first stroke and submits the next
    /// query. Returns the voxels that may look different. If the driver is out of memory it throws MemoryError and
    /// retries when called again, up to the limit above; if a stroke cannot continue (retries exhausted, a
    /// brush that is too large, bricks or the journal fail), it throws another error, drops the rest of the stroke, and
    /// says so.
    std::optional<VoxelBox> advance();
    /// Whether the picture lags behind the annotation after a failed update, which `advance` retries.
    bool is_behind() const { return renderer_.scene().is_behind() && tries_to_show_ < MAX_TRIES; }
    /// Retries at once; fails if that is not possible.
    void catch_up();
    /// Number of interactive strokes painted to their end.
    uint64_t strokes_done() const { return strokes_done_; }
    /// The result of the last finished stroke, interactive or by `paint`.
    const StrokeResult& last_stroke() const { return last_stroke_; }

    /// Applies changes made by trace_edit.h as one command; not while a stroke is running. Returns the command, valid
    /// until the history changes; null if `changes` is empty.
    const Command* edit_trace(std::string label, std::vector<TraceChange> changes);

    /// Applies matching changes as one command; not while a stroke is running. Null if there are none.
    const Command* perform(std::string label, std::vector<Change> changes);

    /// As Work::change_settings; not while a stroke is running. The caller updates the session.
    const Command* change_settings(std::string label, const SettingValues& values);

    /// Returns the command undone or redone; null if none is left, or a stroke is running.
    const Command* undo();
    const Command* redo();
    /// As Work::revert; null also while a stroke is running.
    const Command* revert();

private:
    /// Accumulates the answers of a stroke.
    struct Answered {
        VoxelSelection selection;
        std::optional<DensityStroke> density;  ///< if the brush paints offsets
    };
    struct Stroke {
        PaintOp brush;
        RegionQuery query;
        std::vector<glm::dvec3> positions{};  ///< regions from position `next` on have not been painted yet
        size_t next = 0;
        size_t asked_to = 0;               ///< end of the positions in the query
        std::optional<glm::dvec3> last{};  ///< last position of the hand
        bool has_ended = false;
        bool is_recorded = false;  ///< the last command of the history is this stroke's
        StrokeTally tally{brush};
        StrokeResult result = tally.result();  ///< the painted part so far
        int failed_tries = 0;                  ///< in a row
    };
    /// The records made from an answer.
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
    std::deque<Stroke> strokes_;  ///< strokes in order: the first is being painted; only the last may be open
    uint64_t strokes_done_ = 0;
    StrokeResult last_stroke_;
    uint64_t revision_ = 0;
    int tries_to_show_ = 0;  ///< since the last change
    std::unique_ptr<Work> work_;
};

}  // namespace shvr

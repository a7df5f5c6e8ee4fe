#pragma once
// Executes annotation commands: asks the device which voxels a brush selects, records the result in the history and
// uploads the changed voxels. Scripts, keys, menus and the stylus all go through here.
//
//   PaintOp -> positions along the stroke -> RegionQuery (device) -> VoxelSelection -> records -> Work -> device
//
// The device decides which voxels a brush selects; the code that makes the records decides which of these voxels change
// (painting.h).
//
// A script paints a whole stroke and waits. A user begins, extends and ends a stroke; its parts are painted as the
// device answers. All parts form one command. Used only by the renderer's thread.

#include <deque>
#include <memory>
#include <optional>

#include "engine/annotation/stroke_result.h"
#include "engine/annotation/work/paint_preview.h"
#include "engine/annotation/work/work.h"
#include "engine/live/region_query.h"
#include "engine/session/session.h"

namespace shvr {

/// Returns `op` as the session paints it: an automatic offset is replaced by a number, and the session's locked groups
/// are added. Every paint operation and preview of a user passes through here.
PaintOp in_session(PaintOp op, const Session& session);

/// Returns the files in which a session stores its work.
WorkFiles work_files(const Session& session, const VolumeInfo& volume);
/// Like work_files() above, but with the session's persistent settings as well, except those that `overridden`
/// ("key=value") sets for this run only.
WorkFiles work_files(const Session& session, const VolumeInfo& volume, const std::vector<std::string>& overridden);
/// Adds persistent settings; for callers that apply Work::kept_settings() and report changes to Work::keep_settings.
WorkFiles with_kept_settings(WorkFiles files, const Session& session, const std::vector<std::string>& overridden);

class Annotator {
public:
    /// Maximum number of retries after memory runs out: about 5 s, with the pauses that a window makes.
    static constexpr int MAX_TRIES = 20;

    /// Starts new work, without any paint. The volume must be loaded.
    explicit Annotator(Renderer& renderer);
    /// Continues open work, which another thread may have used before. The caller must make the scene show the work.
    Annotator(Renderer& renderer, std::unique_ptr<Work> work);

    /// For saving, file names and the trace's selection. To change annotations, use the functions below, which also
    /// show the change on the device. They do not fail if memory is too short to show a change: see `is_behind`.
    Work& work() { return *work_; }
    const Work& work() const { return *work_; }
    /// Releases the work to another annotator. This annotator must not be used afterwards.
    std::unique_ptr<Work> take_work() { return std::move(work_); }
    const Document& document() const { return work_->document(); }
    const History& history() const { return work_->history(); }
    Renderer& renderer() const { return renderer_; }
    /// Revision number: incremented by every change of painted groups or offsets.
    uint64_t revision() const { return revision_; }

    /// Like Work::open and Work::choose, but also update the device.
    std::vector<Notice> open(const WorkFiles& files, const Work::Opening& opening = {});
    std::vector<Notice> choose(Belief belief);

    /// Returns the voxels that `op` selects, regardless of their group.
    VoxelSelection select(const PaintOp& op);
    /// Returns the exact preview: the voxels that paint(op) would change now. Paints nothing, but waits for the device;
    /// Previewer (engine/live/previewer.h) does not wait.
    PaintPreview preview(const PaintOp& op);
    /// Like preview() above, but computed from `answers`: the device's answers for all regions of `op`.
    PaintPreview preview(const PaintOp& op, std::span<const RegionAnswer> answers) const;
    /// Paints `op` as one command. Returns the number of voxels whose group changed plus the number whose offset
    /// changed; `last_stroke` has details. All regions of a stroke see the volume as it was before the stroke.
    int64_t paint(const PaintOp& op);

    /// Begins an interactive stroke; ignores `brush.path`. Does not wait, because `advance` paints. Later regions of
    /// the stroke may see offsets painted by earlier ones. The locks of `brush` apply until the stroke ends. Earlier
    /// strokes that are not painted yet are painted first, in order, so the user need not wait for the device.
    void begin_stroke(const PaintOp& brush);
    void extend_stroke(const glm::dvec3& voxel);
    /// Begins and ends a stroke that `advance` paints as `paint` would: all regions see the volume as it is before.
    void begin_whole_stroke(const PaintOp& op);
    /// Interrupts the stroke: nothing is painted between its last position and its next one.
    void lift_stroke()
    {
        if (stroke_is_open()) strokes_.back().last.reset();
    }
    void end_stroke();
    /// Whether a stroke is open, or any part of a stroke has not been painted yet.
    bool stroke_is_running() const { return !strokes_.empty(); }
    /// Whether an interactive stroke has begun but not ended.
    bool stroke_is_open() const { return !strokes_.empty() && !strokes_.back().has_ended; }
    /// Ends all strokes at once. Parts already painted stay; the other parts are dropped.
    void drop_strokes();
    /// Drops the queries in flight after a restart of the device; `advance` submits them again.
    void drop_queries();
    /// Shows changes that earlier could not be shown for lack of memory, paints a finished answer of the first stroke
    /// and submits the next query. Returns the voxels whose appearance may have changed. If the driver is out of
    /// memory, throws MemoryError; the next calls retry, up to MAX_TRIES. If a stroke cannot continue (retries
    /// exhausted, a brush that is too large, failure of bricks or of the journal), drops the rest of the stroke and
    /// throws another error whose message says so.
    std::optional<VoxelBox> advance();
    /// Whether the picture lags behind the annotation, because an update failed or its voxels are being read; `advance`
    /// tries it again.
    bool is_behind() const { return renderer_.scene().is_behind() && tries_to_show_ < MAX_TRIES; }
    /// Tries the update again at once; fails if that fails.
    void catch_up();
    /// Number of interactive strokes that were painted completely.
    uint64_t strokes_done() const { return strokes_done_; }
    /// The result of the last finished stroke, interactive or made by `paint`.
    const StrokeResult& last_stroke() const { return last_stroke_; }

    /// Applies changes made by trace_edit.h as one command. Must not be called while a stroke is running. Returns the
    /// command, valid until the history changes; null if `changes` is empty.
    const Command* edit_trace(std::string label, std::vector<TraceChange> changes);

    /// Applies changes as one command; returns null if there are none. Must not be called while a stroke is running.
    const Command* perform(std::string label, std::vector<Change> changes);

    /// Like Work::change_settings; must not be called while a stroke is running. The caller updates the session.
    const Command* change_settings(std::string label, const SettingValues& values);

    /// Returns the command undone or redone; null if there is none, or while a stroke is running.
    const Command* undo();
    const Command* redo();
    /// Like Work::revert, but also returns null while a stroke is running.
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
        std::vector<glm::dvec3> positions{};  ///< positions of the stroke; those before `next` are painted
        size_t next = 0;
        size_t asked_to = 0;               ///< end of the positions covered by the query in flight
        std::optional<glm::dvec3> last{};  ///< position up to which the stroke has been extended
        bool has_ended = false;
        std::optional<Answered> whole{};  ///< answers so far, if all are painted together at the end
        bool is_recorded = false;         ///< whether the last command of the history is this stroke
        StrokeTally tally{brush};
        StrokeResult result = tally.result();  ///< the painted part so far
        int failed_tries = 0;                  ///< consecutive
    };
    /// The records that an answer leads to.
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
    std::optional<VoxelBox> paint_whole();
    void show(const Touched& touched, const std::optional<VoxelBox>& within = {});
    void show(const Command& command);
    template <class Update>
    void try_to_show(const Update& update);

    Renderer& renderer_;
    std::deque<Stroke> strokes_;  ///< in order: the first stroke is being painted; only the last may be open
    uint64_t strokes_done_ = 0;
    StrokeResult last_stroke_;
    uint64_t revision_ = 0;
    int tries_to_show_ = 0;  ///< since the last change
    std::unique_ptr<Work> work_;
};

}  // namespace shvr

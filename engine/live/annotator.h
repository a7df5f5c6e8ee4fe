#pragma once
// Carries out annotation commands: brushes on the device, their result as exact records in the history, and the changed
// bricks back to the device. Scripts, and later keys, menus and the stylus, all go through here.
//
//   PaintOp -> positions along the stroke -> regions (CPU) -> bits (device) -> VoxelSelection -> records -> History
//
// A script paints a whole stroke and waits. A hand begins a stroke, extends it and ends it; what it covers is painted as
// the device answers, and is one command however many answers that took. One thread, the renderer's.

#include <filesystem>
#include <optional>

#include "engine/annotation/work/paint_preview.h"
#include "engine/annotation/work/script.h"
#include "engine/annotation/work/work.h"
#include "engine/picture/renderer.h"
#include "engine/session/session.h"

namespace shvr {

/// The same, with a number where the offset is automatic.
PaintOp with_offset(PaintOp op, const TransferFunction& function);

/// What a session says of where work is kept.
WorkFiles work_files(const Session& session, const VolumeInfo& volume);

class Annotator {
public:
    /// The volume must be loaded; the mask starts unpainted.
    explicit Annotator(Renderer& renderer);

    const Work& work() const { return work_; }
    const Document& document() const { return work_.document(); }
    const History& history() const { return work_.history(); }
    /// How many voxels the last stroke that ended has changed, of groups and offsets.
    int64_t last_stroke_voxels() const { return last_stroke_voxels_; }

    /// The voxels that `op` selects, whatever their group.
    VoxelSelection select(const PaintOp& op);
    /// The exact preview: the voxels that paint(op) would change now. Nothing is painted. A hand has a Previewer
    /// (engine/live/previewer.h), which does not wait.
    PaintPreview preview(const PaintOp& op);
    /// Counts the changes of groups and offsets.
    uint64_t revision() const { return revision_; }
    /// Paints, as one command. Returns the number of voxels whose group changed and of those whose offset changed,
    /// together. All regions of a stroke see the volume as it was before it.
    int64_t paint(const PaintOp& op);
    /// A stroke by hand: `brush.path` is not read. Nothing waits; `advance` paints. Later regions may see the offsets
    /// that earlier ones have painted.
    void begin_stroke(const PaintOp& brush);
    void extend_stroke(const glm::dvec3& voxel);
    void end_stroke();
    /// A stroke is open, or not all of it has been painted yet.
    bool stroke_is_running() const { return stroke_.has_value(); }
    /// It has begun and not ended.
    bool stroke_is_open() const { return stroke_ && !stroke_->has_ended; }
    /// Ends it at once: what is painted stays, what has not been painted yet is dropped.
    void drop_stroke();
    /// Takes the device's answer, if it is there, paints it and asks the next. Returns the voxels that may have changed. Fails
    /// where the stroke cannot go on (too large a brush, bricks or a journal that fail); then the rest of it is dropped.
    std::optional<VoxelBox> advance();

    /// Carries out what `trace_edit.h` made of the trace, as one command; nothing where `changes` is empty. No stroke is
    /// running.
    void edit_trace(std::string label, std::vector<TraceChange> changes);
    /// No step of the history. What is selected must be there.
    void select_trace(TraceSelection selection) { work_.select_trace(std::move(selection)); }

    /// The command undone or redone; null where there is nothing left, or a stroke is running.
    const Command* undo();
    const Command* redo();
    /// The bricks that a command changed lie in this box; empty where it changed none.
    VoxelBox reach_of(const Command& command) const;

    /// As Work's; what is there comes to the device.
    std::vector<std::string> open(const WorkFiles& files, Work::Start start = Work::Start::as_left);
    /// All paint and offsets come to the device, whose volume was loaded anew.
    void bring_all_to_device();
    /// As Work's.
    std::vector<std::filesystem::path> save(std::vector<LabelImage::Color> looks = {})
    {
        return work_.save(std::move(looks));
    }
    void name_files(const std::filesystem::path& mask, const std::filesystem::path& trace,
                    const std::filesystem::path& density)
    {
        work_.name_files(mask, trace, density);
    }
    void flush() { work_.flush(); }

private:
    friend class Previewer;
    /// A region that the device is asked about.
    struct Asked {
        BrushRegion region;
        glm::dvec3 centre_voxel{0.0};
        uint32_t read_back = 0;
    };
    /// Questions to the device about some positions of a stroke.
    struct Batch {
        std::vector<Asked> regions;
        FrameGraph graph;
    };
    /// What changes are about.
    struct Touched {
        std::vector<int64_t> painted_bricks;
        std::vector<VoxelBox> raised;  ///< voxels whose offsets changed
    };
    /// What answers add up to.
    struct Answered {
        VoxelSelection selection;
        std::optional<DensityStroke> density;  ///< where the brush paints offsets
    };
    struct Stroke {
        PaintOp brush;
        std::vector<glm::dvec3> waiting;  ///< positions that have not been asked about, from `next` on
        size_t next = 0;
        std::optional<glm::dvec3> last;  ///< where the hand was
        std::vector<Asked> asked;
        gpu::Submission answer;
        bool has_ended = false;
        bool is_recorded = false;  ///< a command of the history is this stroke's
        int64_t voxels = 0;
    };
    /// From position `next` on, which it moves. Null where bricks are on their way to the device and `wait` is not set.
    std::optional<Batch> make_batch(const PaintOp& op, std::span<const glm::dvec3> positions, size_t& next, bool wait);
    Answered nothing_yet(const PaintOp& op) const;
    static void add(Answered& answered, const PaintOp& op, std::span<const Asked> asked,
                    const gpu::FrameResult& result);
    Answered ask(const PaintOp& op);
    std::vector<Change> changes_of(const PaintOp& op, const Answered& answered) const;
    PaintPreview preview_with(const PaintOp& op, const Answered& answered) const;
    std::optional<VoxelBox> advance_stroke();
    std::optional<VoxelBox> paint_answer();
    Touched touched_by(std::span<const Change> changes) const;
    void bring_to_device(const Touched& touched);
    Renderer& renderer_;
    std::optional<Stroke> stroke_;
    int64_t last_stroke_voxels_ = 0;
    uint64_t revision_ = 0;
    Work work_;
};

}  // namespace shvr

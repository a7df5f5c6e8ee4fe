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

#include "engine/annotation/history.h"
#include "engine/annotation/script.h"
#include "engine/scene/renderer.h"

namespace shvr {

class Annotator {
public:
    /// The volume must be loaded; the mask starts unpainted.
    explicit Annotator(Renderer& renderer);

    const Document& document() const { return document_; }
    const History& history() const { return history_; }
    /// How many voxels the last stroke that ended has changed.
    int64_t last_stroke_voxels() const { return last_stroke_voxels_; }

    /// What `op` would paint: the exact preview, and what paint() uses.
    VoxelSelection select(const PaintOp& op);
    /// Paints, as one command. Returns the number of voxels whose group changed.
    int64_t paint(const PaintOp& op);
    /// A stroke by hand: `brush.path` is not read. Nothing waits; `advance` paints.
    void begin_stroke(const PaintOp& brush);
    void extend_stroke(const glm::dvec3& voxel);
    void end_stroke();
    /// A stroke is open, or not all of it has been painted yet.
    bool stroke_is_running() const { return stroke_.has_value(); }
    /// It has begun and not ended.
    bool stroke_is_open() const { return stroke_ && !stroke_->has_ended; }
    /// Takes the device's answer, if it is there, paints it and asks the next. Returns the voxels that may have changed.
    std::optional<VoxelBox> advance();

    /// The command undone or redone; null where there is nothing left, or a stroke is running.
    const Command* undo();
    const Command* redo();
    /// The bricks that a command changed lie in this box.
    VoxelBox reach_of(const Command& command) const;

    /// Replaces the (unpainted) mask by a file's; not a step of the history. Fails where it was painted on another image
    /// (engine/annotation/mask_image.h), which saving notes. `volume_hash`: Session::volume_hash.
    void load(const std::filesystem::path& mask_file, const std::string& volume_hash = {});
    void save(const std::filesystem::path& mask_file, const std::string& volume_hash = {}) const;

private:
    /// Questions to the device about some positions of a stroke.
    struct Batch {
        std::vector<BrushRegion> regions;
        std::vector<uint32_t> read_backs;  ///< of each region
        FrameGraph graph;
    };
    struct Stroke {
        PaintOp brush;
        std::vector<glm::dvec3> waiting;  ///< positions that have not been asked about, from `next` on
        size_t next = 0;
        std::optional<glm::dvec3> last;  ///< where the hand was
        std::vector<BrushRegion> asked;
        std::vector<uint32_t> read_backs;
        gpu::Submission answer;
        bool has_ended = false;
        bool is_recorded = false;  ///< a command of the history is this stroke's
        int64_t voxels = 0;
    };
    /// From position `next` on, which it moves. Null where bricks are on their way to the device and `wait` is not set.
    std::optional<Batch> make_batch(const PaintOp& op, std::span<const glm::dvec3> positions, size_t& next, bool wait);
    std::optional<VoxelBox> paint_answer();
    void bring_to_device(const Command& command);
    Renderer& renderer_;
    std::optional<Stroke> stroke_;
    int64_t last_stroke_voxels_ = 0;
    Document document_;
    History history_;
};

}  // namespace shvr

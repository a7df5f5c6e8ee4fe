#pragma once
// Carries out annotation commands: brushes on the device, their result as exact records in the history, and the changed
// bricks back to the device. Scripts, and later keys, menus and the stylus, all go through here.
//
//   PaintOp -> positions along the stroke -> regions (CPU) -> bits (device) -> VoxelSelection -> records -> History
//
// One thread, the renderer's.

#include <filesystem>

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

    /// What `op` would paint: the exact preview, and what paint() uses.
    VoxelSelection select(const PaintOp& op);
    /// Paints, as one command. Returns the number of voxels whose group changed.
    int64_t paint(const PaintOp& op);
    /// False where there is nothing left to undo or redo.
    bool undo();
    bool redo();

    /// Replaces the (unpainted) mask by a file's; not a step of the history.
    void load(const std::filesystem::path& mask_file);
    void save(const std::filesystem::path& mask_file) const;

private:
    void bring_to_device(const Command& command);
    Renderer& renderer_;
    Document document_;
    History history_;
};

}  // namespace shvr

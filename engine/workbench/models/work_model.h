#pragma once
// View of the annotation: painting, tracing, history and saving.

#include <array>
#include <optional>
#include <span>

#include "engine/annotation/work/work.h"

namespace shvr::ui {

/// Made by the painter.
struct PaintModel {
    bool is_painting = false;     ///< a stroke is open, or not yet fully painted
    bool stroke_is_open = false;  ///< the hand is down
    /// Number of voxels that painting would change now; nothing if no preview is shown or it is pending.
    std::optional<int64_t> previewed_voxels;
    std::array<int64_t, 256> voxels_by_group{};
};

/// Made by the tracer.
struct TraceModel {
    const TraceGraph& trace;
    std::optional<uint32_t> nearby_node;  ///< near the probe, and not selected
    bool drags_node = false;
    bool is_cut = false;  ///< the last deletion cut the trace in two, and the cut has not been mended
};

/// Made by the settings' editor.
struct HistoryModel {
    const History* history = nullptr;   ///< null where nothing is open
    size_t undoable = 0, redoable = 0;  ///< a setting that is not a step of the history yet counts as undoable
};

/// Made by the saver.
struct SaveModel {
    bool is_saved = true;
    bool is_saving = false;               ///< files are being written; later changes are not in them
    bool is_saving_as = false;            ///< saving under another name: commands are refused until it ends
    std::span<const Dispute> disputes{};  ///< saved files that other processes have changed; empty: nothing to choose
};

}  // namespace shvr::ui

#pragma once
// Read-only view of the annotation: painting, tracing, history and saving.

#include <array>
#include <optional>
#include <span>
#include <string>

#include "engine/annotation/work/work.h"

namespace shvr::ui {

/// Made by the painter.
struct PaintModel {
    bool is_painting = false;     ///< a stroke is in progress, or has ended but is not fully painted yet
    bool stroke_is_open = false;  ///< the hand is down
    /// Number of voxels that painting would change now; null if no preview is shown or its result is not known yet.
    std::optional<int64_t> previewed_voxels;
    std::array<int64_t, 256> voxels_by_group{};
};

/// Made by the editor of groups: what an operation would change, before it does.
struct OperationModel {
    std::string previewed;            ///< line of the operation (PreviewOperation); empty: none
    std::string preview_words;        ///< what it would change, or why it cannot; empty: not known yet
    bool is_previewing = false;       ///< the answer is being computed
    bool is_preview_current = false;  ///< the answer is known and is about the present annotation
    bool has_preview_failed = false;  ///< `preview_words` say why
    /// Line of the operation that is carried out, or that made the present annotation. Empty: neither, or another one
    /// was previewed since.
    std::string applied;
    bool is_applying = false;  ///< it is still being carried out
};

/// Made by the tracer.
struct TraceModel {
    const TraceGraph& trace;
    std::optional<uint32_t> nearby_node;  ///< near the probe, and not selected
    bool drags_node = false;
    bool is_cut = false;  ///< the last deletion cut the trace, and its two ends are not linked again yet
};

/// Made by the settings' editor.
struct HistoryModel {
    const History* history = nullptr;   ///< null where nothing is open
    size_t undoable = 0, redoable = 0;  ///< includes changed settings that are not a step of the history yet
};

/// Made by the saver.
struct SaveModel {
    bool is_saved = true;
    bool is_saving = false;               ///< a save is in progress; changes made since it began are not part of it
    bool is_saving_as = false;            ///< the save is under another name: until it ends, commands are refused
    std::span<const Dispute> disputes{};  ///< saved files that others changed; the user must choose; empty: none
    /// Why work cannot be saved now: the folder or the journal cannot be written to, or the last save failed. Empty:
    /// nothing is in the way, as far as is known.
    std::string trouble{};
    bool is_trouble_of_folder = false;  ///< nothing can be written next to the session: only another folder helps
    bool is_kept = true;                ///< nothing would be lost if the program ended now, except settings
    bool kept_window_open = false;      ///< the window was to be closed, and was not because of this trouble
    bool waits_to_close = false;        ///< the window closes once the jobs that write files have ended
};

}  // namespace shvr::ui

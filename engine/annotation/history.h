#pragma once
// One history for everything a person does. A command is a label and a list of change records, each of which holds
// exact before and after; undo and redo are one loop over the records and know nothing of tools. A new tool makes new
// command contents, never new undo code; a new kind of annotation adds one alternative to `Change`.
//
// Not thread safe: the main thread owns it.

#include <string>
#include <variant>
#include <vector>

#include "engine/annotation/density.h"
#include "engine/annotation/mask.h"
#include "engine/annotation/tracing.h"

namespace shvr {

/// Everything that is annotated. Nothing but `apply` changes it.
struct Document {
    Mask mask;
    TraceGraph trace;
    DensityField density{};
};

using Change = std::variant<MaskBrickChange, TraceChange, DensityBrickChange>;

struct Command {
    std::string label;  ///< what the status bar says: "flood fill, group 3"
    std::vector<Change> changes;
};

void apply(Document& document, const Change& change, Direction direction);

class History {
public:
    /// Applies the command and records it; what had been undone is dropped. A command without changes is not recorded.
    void perform(Document& document, Command command);
    /// Applies `changes` and adds them to the command performed last, of which nothing was undone since: a stroke goes on.
    void extend(Document& document, std::vector<Change> changes);
    /// The command undone or redone, or null where there is none.
    const Command* undo(Document& document);
    const Command* redo(Document& document);

    size_t undoable() const { return done_; }
    size_t redoable() const { return commands_.size() - done_; }

private:
    std::vector<Command> commands_;
    size_t done_ = 0;  ///< commands_[0 .. done_) are in effect
};

}  // namespace shvr

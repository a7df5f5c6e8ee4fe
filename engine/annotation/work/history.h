#pragma once
// One history for everything the user does. Undo and redo are one loop over the records of a command and independent of
// tools: a new tool makes new command contents, never new undo code.
//
// Commands that the journal contains can be dropped from memory, oldest first; undoing one fetches it again.
//
// Not thread safe: the main thread owns it.

#include <functional>

#include "engine/annotation/work/change.h"

namespace shvr {

/// The number of a record in the journal.
using RecordNumber = uint64_t;

class History {
public:
    /// Reads a record's content from the journal; fails if it cannot be read.
    using Fetch = std::function<std::vector<Change>(RecordNumber)>;

    /// Applies the command and records it; drops commands that were undone. Returns the command, valid until the
    /// history changes; null if the command has no changes and so is not recorded. `record`: its number in the journal.
    const Command* perform(Document& document, Command command, RecordNumber record = 0);
    /// Applies `changes` and adds them to the last command, for instance when a stroke continues. Nothing may have been
    /// undone since that command.
    void extend(Document& document, std::vector<Change> changes, RecordNumber record = 0);
    /// Return the command that was undone or redone; null if there is none. If the command was dropped and cannot be
    /// fetched or does not fit, fail and change nothing.
    const Command* undo(Document& document);
    const Command* redo(Document& document);

    /// Replay perform(), extend(), undo() and redo() for a document in its final state, so that no changes are needed.
    void note(std::string label, RecordNumber record);
    void note_extension(RecordNumber record);
    void note_undo();
    void note_redo();

    size_t undoable() const { return done_; }
    size_t redoable() const { return commands_.size() - done_; }

    /// The label of a step; steps count from 0, the oldest, to undoable() + redoable() - 1. Always in memory.
    const std::string& label_of(size_t step) const { return commands_[step].command.label; }
    /// The step's first record in the journal; 0: it has none.
    RecordNumber record_of(size_t step) const { return commands_[step].records.front(); }
    /// Passes the changes of a step to `visit`. Fetches the changes if they were dropped, and fails if that is
    /// impossible. The span is valid only during the call.
    void look_at(size_t step, const std::function<void(std::span<const Change>)>& visit) const;

    void fetch_from(Fetch fetch) { fetch_ = std::move(fetch); }
    uint64_t memory_bytes() const { return memory_; }
    /// Drops the changes of the oldest commands until at most `max_bytes` are left. Only drops commands whose records
    /// are on disk, that is, up to the record `durable`.
    void shrink(uint64_t max_bytes, RecordNumber durable);

private:
    struct Entry {
        Command command;
        std::vector<RecordNumber> records;
        uint64_t memory = 0;
        bool is_here = true;  ///< its changes are in memory
    };
    void push(Entry entry);
    void bring(Entry& entry);
    std::vector<Change> fetched(const Entry& entry) const;

    std::vector<Entry> commands_;
    size_t done_ = 0;     ///< commands_[0 .. done_) are in effect
    size_t dropped_ = 0;  ///< commands_[0 .. dropped_) have been dropped, unless they were fetched again
    uint64_t memory_ = 0;
    Fetch fetch_;
};

}  // namespace shvr

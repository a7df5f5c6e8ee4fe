#pragma once
// One history for everything the user does. Undo and redo are one loop over the records of
// a command, whatever made them: a new tool needs new command contents, but no new undo
// code.
//
// Commands that are in the journal can be dropped from memory, oldest first; undoing a
// dropped command fetches it again.

#include <functional>

#include "engine/annotation/work/change.h"

namespace shvr {

/// The number of a record in the journal.
using RecordNumber = uint64_t;

class History {
public:
    /// A function that reads a record's content from the journal, and fails if that is impossible.
    using Fetch = std::function<std::vector<Change>(RecordNumber)>;

    /// Applies the command and records it; discards commands that were undone. Returns the command (valid until the
    /// history changes), or null without recording if the command has no changes. `record`: its number in the journal.
    const Command* perform(Document& document, Command command, RecordNumber record = 0);
    /// Applies `changes` and adds them to the last command, for instance when a stroke continues. The last command must
    /// not have been undone.
    void extend(Document& document, std::vector<Change> changes, RecordNumber record = 0);
    /// Return the command that was undone or redone; null if there is none. Fail, without any change, if the command
    /// was dropped and cannot be fetched, or does not fit.
    const Command* undo(Document& document);
    const Command* redo(Document& document);

    /// Replay perform(), extend(), undo(), redo() without applying changes: the document already has its final state.
    void note(std::string label, RecordNumber record);
    void note_extension(RecordNumber record);
    void note_undo();
    void note_redo();

    size_t undoable() const { return done_; }
    size_t redoable() const { return commands_.size() - done_; }

    /// The label of a step, even if it was dropped. Steps count from 0 (the oldest) to undoable() + redoable() - 1.
    const std::string& label_of(size_t step) const { return commands_[step].command.label; }
    /// Number of the step's first record in the journal; 0 if it has no record.
    RecordNumber record_of(size_t step) const { return commands_[step].records.front(); }
    /// Passes the changes of a step to `visit`; the span is valid only during the call. If the changes were dropped,
    /// fetches them, and fails if that is impossible.
    void look_at(size_t step, const std::function<void(std::span<const Change>)>& visit) const;

    void fetch_from(Fetch fetch) { fetch_ = std::move(fetch); }
    uint64_t memory_bytes() const { return memory_; }
    /// Drops the changes of the oldest commands from memory until at most `max_bytes` are left. Only drops commands
    /// whose records are on disk: those up to the record `durable`.
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

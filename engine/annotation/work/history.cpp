#include "engine/annotation/work/history.h"

#include <utility>

#include "engine/base/error.h"

namespace shvr {

void History::push(Entry entry)
{
    while (commands_.size() > done_) {
        memory_ -= commands_.back().memory;
        commands_.pop_back();
    }
    dropped_ = std::min(dropped_, done_);
    memory_ += entry.memory;
    commands_.push_back(std::move(entry));
}

const Command* History::perform(Document& document, Command command, RecordNumber record)
{
    if (command.changes.empty()) return nullptr;
    for (const Change& change : command.changes) apply(document, change, Direction::forwards);
    const uint64_t memory = memory_of(command.changes);
    push({std::move(command), {record}, memory});
    ++done_;
    return &commands_.back().command;
}

void History::extend(Document& document, std::vector<Change> changes, RecordNumber record)
{
    SHVR_CHECK(done_ > 0 && done_ == commands_.size(), done_, " of ", commands_.size());
    Entry& entry = commands_.back();
    bring(entry);
    const uint64_t memory = memory_of(changes);
    entry.memory += memory;
    memory_ += memory;
    entry.records.push_back(record);
    for (Change& change : changes) {
        apply(document, change, Direction::forwards);
        entry.command.changes.push_back(std::move(change));
    }
}

const Command* History::undo(Document& document)
{
    if (done_ == 0) return nullptr;
    Entry& entry = commands_[done_ - 1];
    bring(entry);
    apply_if_it_fits(document, entry.command.changes, Direction::backwards);
    --done_;
    return &entry.command;
}

const Command* History::redo(Document& document)
{
    if (done_ == commands_.size()) return nullptr;
    Entry& entry = commands_[done_];
    bring(entry);
    apply_if_it_fits(document, entry.command.changes, Direction::forwards);
    ++done_;
    return &entry.command;
}

void History::note(std::string label, RecordNumber record)
{
    push({{std::move(label), {}}, {record}, 0, false});
    ++done_;
}

void History::note_extension(RecordNumber record)
{
    if (done_ == 0 || done_ != commands_.size()) fail("a stroke continues that is not the last command");
    commands_.back().records.push_back(record);
}

void History::note_undo()
{
    if (done_ == 0) fail("more commands are undone than were done");
    --done_;
}

void History::note_redo()
{
    if (done_ == commands_.size()) fail("more commands are redone than were undone");
    ++done_;
}

std::vector<Change> History::fetched(const Entry& entry) const
{
    std::vector<Change> changes;
    for (const RecordNumber record : entry.records)
        for (Change& change : fetch_(record)) changes.push_back(std::move(change));
    return changes;
}

void History::look_at(size_t step, const std::function<void(std::span<const Change>)>& visit) const
{
    SHVR_CHECK(step < commands_.size(), step, " of ", commands_.size());
    const Entry& entry = commands_[step];
    if (entry.is_here) return visit(entry.command.changes);
    visit(fetched(entry));
}

void History::bring(Entry& entry)
{
    if (entry.is_here) return;
    entry.command.changes = fetched(entry);
    entry.memory = memory_of(entry.command.changes);
    entry.is_here = true;
    memory_ += entry.memory;
    dropped_ = 0;
}

void History::shrink(uint64_t max_bytes, RecordNumber durable)
{
    // Keeps the last command, because it may still be extended, and callers may still hold a pointer to it.
    for (; memory_ > max_bytes && dropped_ + 1 < done_; ++dropped_) {
        Entry& entry = commands_[dropped_];
        if (entry.records.back() == 0 || entry.records.back() > durable) return;
        if (!entry.is_here) continue;
        memory_ -= std::exchange(entry.memory, 0);
        entry.command.changes = {};
        entry.is_here = false;
    }
}

}  // namespace shvr

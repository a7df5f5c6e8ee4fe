#include "engine/annotation/history.h"

#include <ranges>
#include <utility>

#include "engine/base/error.h"

namespace shvr {

void apply(Document& document, const Change& change, Direction direction)
{
    if (const auto* mask = std::get_if<MaskBrickChange>(&change))
        document.mask.apply(*mask, direction);
    else if (const auto* density = std::get_if<DensityBrickChange>(&change))
        document.density.apply(*density, direction);
    else
        document.trace.apply(std::get<TraceChange>(change), direction);
}

void History::perform(Document& document, Command command)
{
    if (command.changes.empty()) return;
    commands_.resize(done_);
    commands_.push_back(std::move(command));
    redo(document);
}

void History::extend(Document& document, std::vector<Change> changes)
{
    SHVR_CHECK(done_ > 0 && done_ == commands_.size(), done_, " of ", commands_.size());
    for (Change& change : changes) {
        apply(document, change, Direction::forwards);
        commands_.back().changes.push_back(std::move(change));
    }
}

const Command* History::undo(Document& document)
{
    if (done_ == 0) return nullptr;
    const Command& command = commands_[--done_];
    for (const Change& change : std::views::reverse(command.changes)) apply(document, change, Direction::backwards);
    return &command;
}

const Command* History::redo(Document& document)
{
    if (done_ == commands_.size()) return nullptr;
    const Command& command = commands_[done_++];
    for (const Change& change : command.changes) apply(document, change, Direction::forwards);
    return &command;
}

}  // namespace shvr

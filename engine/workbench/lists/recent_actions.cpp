#include "engine/workbench/lists/recent_actions.h"

#include "engine/base/error.h"
#include "engine/workbench/actions/action_rows.h"

namespace shvr::ui {

namespace {

/// Returns whether mouse motion or a held key repeats the action many times a second.
bool comes_in_runs(const Action& action)
{
    return action.is<Orbit>() || action.is<Roll>() || action.is<Move>() || action.is<Zoom>() ||
           action.is<DragInMap>() || action.is<MoveCut>() || action.is<MoveClip>() || action.is<ProbeTo>() ||
           action.is<PushProbe>() || action.is<ScaleProbe>();
}

}  // namespace

void RecentActions::begin(const Action& action)
{
    if (!entries_.empty() && entries_.back().is_done && entries_.back().action.index() == action.index() &&
        comes_in_runs(action)) {
        entries_.back() = {action, entries_.back().times + 1, false};
        return;
    }
    entries_.push_back({action, 1, false});
    if (entries_.size() > MAX_ENTRIES) entries_.pop_front();
}

std::vector<std::string> RecentActions::lines() const
{
    std::vector<std::string> lines;
    for (const Entry& entry : entries_) {
        std::string line = line_of(entry.action);
        if (!entry.is_done)
            line += " # refused";
        else if (entry.times > 1)
            line += sentence(" # the last of ", entry.times);
        lines.push_back(std::move(line));
    }
    return lines;
}

}  // namespace shvr::ui

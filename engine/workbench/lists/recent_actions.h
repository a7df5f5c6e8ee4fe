#pragma once
// The last actions, for bug reports. Actions that follow the mouse arrive many times a second, so successive actions of
// one kind become one entry, which stores the last of them. Entries store actions as structs, and turn them into text
// only on request, so recording an action costs no more than a copy. Main thread only.

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "engine/workbench/actions/action.h"

namespace shvr::ui {

class RecentActions {
public:
    static constexpr size_t MAX_ENTRIES = 50;

    void begin(const Action& action);
    /// Notes that the newest action was carried out. Without this call, the report says that the action was refused.
    void note_done() { entries_.back().is_done = true; }
    /// Returns lines that replay the actions, oldest first (action_rows.h). After " # ", a comment states that an
    /// action was refused, or how many actions an entry stands for.
    std::vector<std::string> lines() const;

private:
    struct Entry {
        Action action;
        uint64_t times = 1;
        bool is_done = false;
    };
    std::deque<Entry> entries_;
};

}  // namespace shvr::ui

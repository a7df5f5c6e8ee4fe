#pragma once
// The last actions, for bug reports. Actions that follow the mouse arrive many times a second, so a run of actions of
// one kind is one entry, which stores the last of them. Actions are stored unformatted and formatted only on request,
// so recording an action costs only its copy. Main thread only.

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
    /// Marks the most recently begun action as carried out.
    void note_done() { entries_.back().is_done = true; }
    /// Returns lines that replay the actions, oldest first (action_rows.h). A comment after " # " states that the
    /// action was refused, or how many actions its run had.
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

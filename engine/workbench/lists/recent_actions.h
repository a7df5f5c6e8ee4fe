#pragma once
// The last actions, for bug reports. Actions that follow the mouse arrive many times a second: a run of one kind is
// one entry, which holds the last. Actions are stored as they are and formatted only on request, so that recording
// one costs its copy. The main thread.

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
    /// Marks the last action begun as carried out.
    void note_done() { entries_.back().is_done = true; }
    /// Returns lines that replay the actions, oldest first (action_rows.h), followed by " # " and a note that the
    /// action was refused, or the length of its run.
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

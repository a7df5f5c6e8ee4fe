#pragma once
// The last actions, for reports of what went wrong. What follows the mouse comes many times a second: a run of one kind
// is one entry, which holds the last. Kept as they are and made into lines only when asked, so that remembering one
// costs its copy. The main thread.

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
    /// The one that began last was carried out.
    void note_done() { entries_.back().is_done = true; }
    /// Oldest first: lines that replay them (action_rows.h), and after " # " whether it was refused, or the last of how
    /// many of its kind.
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

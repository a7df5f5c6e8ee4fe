#pragma once
// Records the relevance that was passed to a servo: the mirror's thread adds entries, the main thread takes them. The
// servo itself reports only the sequence number in use, so it neither copies bits nor waits for a lock.

#include <deque>
#include <memory>
#include <mutex>
#include <optional>

#include "haptics/replay/trace_relevance.h"

namespace shvr::ui {

class RelevanceLog {
public:
    /// Maximum number of waiting entries; further ones are dropped. Without take(), this takes eight seconds or more.
    static constexpr size_t MAX_ENTRIES = 1024;

    /// Main thread, before and after a recording
    void begin();
    void end();
    /// Call this before publishing `patch`, on the same thread. Each sequence number is recorded only once.
    void note(const RelevancePatch& patch);
    /// Returns the oldest entry whose sequence number is at most `sequence`; null if there is none. Main thread.
    std::optional<TraceRelevance> take(uint64_t sequence);

private:
    std::mutex mutex_;  ///< guards all members; held for less than a millisecond
    bool is_on_ = false;
    std::deque<TraceRelevance> entries_;
    std::unique_ptr<RelevancePatch> last_;
};

}  // namespace shvr::ui

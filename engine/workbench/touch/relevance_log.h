#pragma once
// Records the relevance passed to a servo: the mirror's thread adds entries, and the main thread takes them. The servo
// itself reports only the sequence in use, so it neither copies bits nor waits for a lock.

#include <deque>
#include <memory>
#include <mutex>
#include <optional>

#include "haptics/replay/trace_relevance.h"

namespace shvr::ui {

class RelevanceLog {
public:
    /// Maximum number of waiting entries; later ones are dropped. Eight seconds if every mirror iteration adds one.
    static constexpr size_t MAX_ENTRIES = 1024;

    /// Main thread, before and after a recording
    void begin();
    void end();
    /// Call before `patch` is published, on the publisher's thread. A sequence is recorded only once.
    void note(const RelevancePatch& patch);
    /// Returns the next entry that is no newer than `sequence`. Main thread.
    std::optional<TraceRelevance> take(uint64_t sequence);

private:
    std::mutex mutex_;  ///< guards all members; held for less than a millisecond
    bool is_on_ = false;
    std::deque<TraceRelevance> entries_;
    std::unique_ptr<RelevancePatch> last_;
};

}  // namespace shvr::ui

#pragma once
// Relevance passed to a servo, for a recording: the mirror's thread records it, the main thread takes it. The
// servo itself reports only the sequence in use, so it neither copies bits nor meets a lock.

#include <deque>
#include <memory>
#include <mutex>
#include <optional>

#include "haptics/replay/trace_relevance.h"

namespace shvr::ui {

class RelevanceLog {
public:
    /// Maximum number of entries not yet taken; later ones are dropped. Eight seconds of new bits per mirror iteration.
    static constexpr size_t MAX_ENTRIES = 1024;

    /// Main thread, before and after a recording
    void begin();
    void end();
    /// Call before `patch` is published; the same sequence is recorded once. The publisher's thread.
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

#pragma once
// What relevance was handed to a servo, for a recording: the mirror's thread notes it, the main thread takes it. The
// servo itself tells only which of it is in use, so it neither copies bits nor meets a lock.

#include <deque>
#include <memory>
#include <mutex>
#include <optional>

#include "haptics/replay/trace_relevance.h"

namespace shvr::ui {

class RelevanceLog {
public:
    /// More of it, not yet taken, are not kept: eight seconds of new bits every turn of the mirror.
    static constexpr size_t MAX_ENTRIES = 1024;

    /// Main thread, before and after a recording
    void begin();
    void end();
    /// Before `patch` is published; the same sequence is noted once. The publisher's thread.
    void note(const RelevancePatch& patch);
    /// The next one that is no newer than `sequence`. Main thread.
    std::optional<TraceRelevance> take(uint64_t sequence);

private:
    std::mutex mutex_;  ///< of all; held for less than a millisecond
    bool is_on_ = false;
    std::deque<TraceRelevance> entries_;
    std::unique_ptr<RelevancePatch> last_;
};

}  // namespace shvr::ui

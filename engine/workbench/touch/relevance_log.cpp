#include "engine/workbench/touch/relevance_log.h"

namespace shvr::ui {

void RelevanceLog::begin()
{
    const std::scoped_lock lock(mutex_);
    entries_.clear();
    last_ = std::make_unique<RelevancePatch>();
    is_on_ = true;
}

void RelevanceLog::end()
{
    const std::scoped_lock lock(mutex_);
    entries_.clear();
    last_.reset();
    is_on_ = false;
}

void RelevanceLog::note(const RelevancePatch& patch)
{
    const std::scoped_lock lock(mutex_);
    if (!is_on_ || patch.sequence == last_->sequence || entries_.size() >= MAX_ENTRIES) return;
    entries_.push_back(note_relevance(patch, *last_));
    *last_ = patch;
}

std::optional<TraceRelevance> RelevanceLog::take(uint64_t sequence)
{
    const std::scoped_lock lock(mutex_);
    if (entries_.empty() || entries_.front().sequence > sequence) return std::nullopt;
    std::optional<TraceRelevance> first(std::move(entries_.front()));
    entries_.pop_front();
    return first;
}

}  // namespace shvr::ui

#pragma once
// Receives the progress of work in several stages, and tells the work when to stop. The progress goes to a job
// (jobs.h), the progress line of a command, or nowhere. Used by one thread at a time, the working thread.

#include <atomic>
#include <string>
#include <utility>

#include "engine/base/progress.h"

namespace shvr {

class ProgressReporter {
public:
    virtual ~ProgressReporter() = default;
    ProgressReporter() = default;
    ProgressReporter(const ProgressReporter&) = delete;
    ProgressReporter& operator=(const ProgressReporter&) = delete;

    /// Starts a stage, as in "writing stem.swc", whose time left is estimated from scratch. Returns a function that
    /// reports the stage's progress. Both throw `Stopped` if the work is to stop; the function must not outlive this.
    virtual Progress begin(const std::string& what) = 0;
    /// Reports progress as the function returned by begin() does, but with a detail, as in "120 MB/s", and with the
    /// caller's better estimate of the time left.
    virtual void show(double fraction, const std::string& detail, double seconds_left) = 0;
    /// The flag that asks the work to stop, for functions that poll it themselves. It outlives the work.
    virtual const std::atomic<bool>& stop_requested() const = 0;
};

/// For callers that need only the fraction of each stage, or no progress at all.
class PlainReporter final : public ProgressReporter {
public:
    explicit PlainReporter(Progress progress = {}) : progress_(std::move(progress)) {}
    Progress begin(const std::string&) override { return progress_; }
    void show(double fraction, const std::string&, double) override { tell(progress_, fraction); }
    const std::atomic<bool>& stop_requested() const override { return never_; }

private:
    Progress progress_;
    std::atomic<bool> never_ = false;
};

}  // namespace shvr

#pragma once
// Receives the progress of work in several stages, and tells the work when to stop. A reporter passes the progress to a
// job (jobs.h), to a command's progress line, or nowhere. Only the working thread uses it.

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

    /// Starts a stage such as "writing stem.swc", with a new estimate of the time left. Returns a function that reports
    /// the stage's progress and must not outlive this reporter. Both throw `Stopped` if the work should stop.
    virtual Progress begin(const std::string& what) = 0;
    /// Reports progress like the function that begin() returns, but with a detail such as "120 MB/s", and with the
    /// caller's own estimate of the time left, which is more accurate.
    virtual void show(double fraction, const std::string& detail, double seconds_left) = 0;
    /// Returns the flag that is set when the work should stop, for functions that poll it. The flag outlives the work.
    virtual const std::atomic<bool>& stop_requested() const = 0;
};

/// A reporter for callers that need only the fraction of each stage, or no progress at all.
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

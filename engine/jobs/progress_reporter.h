#pragma once
// Receives the progress of long work in several stages, and tells it when to stop: for a job (jobs.h), the progress
// line of a command, or nothing. One thread at a time, the one that works.

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

    /// Starts a stage, as in "writing stem.swc"; its time left is estimated from scratch. The returned function, and
    /// this one, throw `Stopped` if the work is to stop; it must not outlive the reporter.
    virtual Progress begin(const std::string& what) = 0;
    /// Like calling that function with a fraction, with a detail, as in "120 MB/s", and a better estimate of the time
    /// left.
    virtual void show(double fraction, const std::string& detail, double seconds_left) = 0;
    /// For functions that poll for themselves. It outlives the work.
    virtual const std::atomic<bool>& stop_requested() const = 0;
};

/// For callers that only need the fraction of each stage, or nothing.
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

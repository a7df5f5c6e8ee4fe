#pragma once
// Where long work in several stretches tells how far it is, and whether it is to end: a job (jobs.h), the line of a
// command, or nowhere. One thread at a time, the one that works.

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

    /// A stretch of work begins, as in "writing stem.swc"; its time left is estimated anew. The result throws `Stopped`
    /// once the work is to end, as does this; it must not outlive the reporter.
    virtual Progress begin(const std::string& what) = 0;
    /// The same as calling the result with the share, with a detail, as in "120 MB/s", and a better estimate of the
    /// time left.
    virtual void show(double fraction, const std::string& detail, double seconds_left) = 0;
    /// For functions that look for themselves. It outlives the work.
    virtual const std::atomic<bool>& stop_requested() const = 0;
};

/// For those who only want the share of each stretch, or nothing.
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

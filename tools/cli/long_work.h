#pragma once
// Shared by commands with long work: shows progress (engine/base/progress.h), and makes Ctrl-C stop the command
// cleanly, with a message.

#include <atomic>
#include <cstdint>
#include <string>

#include "engine/jobs/progress_reporter.h"
#include "tools/cli/stop.h"

namespace shvr::cli {

/// At most one instance exists, on the thread that runs the command. During its lifetime, the first Ctrl-C (SIGINT) or
/// SIGTERM asks the command to stop (stop.h); the command then ends as after an error, with its files either complete
/// or absent. A second signal ends the program at once. Unless `quiet`, a line on standard error shows the progress of
/// work that takes longer than a second, even if the work reports none.
class LongWork final : public ProgressReporter {
public:
    explicit LongWork(bool quiet);
    ~LongWork() override;

    Progress begin(const std::string& what) override;
    /// Does not throw.
    void show(double fraction, const std::string& detail, double seconds_left) override;
    /// Throws `Stopped` if the command was asked to stop.
    void stop_if_asked() const;
    bool is_asked_to_stop() const { return stop_.is_made(); }
    const std::atomic<bool>& stop_requested() const override { return StopRequest::flag(); }

private:
    StopRequest stop_;
};

/// Returns the description of the last work that was begun, such as "loading scan.nrrd"; empty: none was begun.
std::string last_begun();
/// Returns the peak memory use of this process.
int64_t peak_mebibytes();
/// Erases the progress line from the terminal until its next update. Call before printing anything.
void clear_progress();
/// Prints a line on standard error without garbling the progress line.
void print_beside_progress(const std::string& line);

}  // namespace shvr::cli

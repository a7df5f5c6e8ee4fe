#pragma once
// What long work of a command has in common: it shows how far it is (engine/base/progress.h), and Ctrl-C ends it in a
// sentence.

#include <atomic>
#include <string>

#include "engine/base/progress.h"
#include "tools/cli/stop.h"

namespace shvr::cli {

/// One at a time, on the thread that runs the command. While it lives, the first Ctrl-C (SIGINT) or SIGTERM asks the
/// command to stop (stop.h), which then ends as after an error: files are whole or not there. A second one ends the
/// program at once. What takes longer than a second shows a line on standard error, unless `quiet`; so does work that
/// never says how far it is.
class LongWork {
public:
    explicit LongWork(bool quiet);
    ~LongWork();
    LongWork(const LongWork&) = delete;

    /// A stretch of work begins, as in "measuring". Calling the result shows how far it is, and throws `Stopped` once
    /// the command was asked to stop. It must not outlive this.
    Progress begin(const std::string& what);
    /// The same with a detail, as in "120 MB/s", and a better estimate of the time left.
    void show(double fraction, const std::string& detail, double seconds_left);
    /// Throws `Stopped` if the command was asked to stop.
    void stop_if_asked() const;
    bool is_asked_to_stop() const { return stop_.is_made(); }
    /// For engine functions that look for themselves.
    static const std::atomic<bool>& stop_requested() { return StopRequest::flag(); }

private:
    StopRequest stop_;
};

/// Takes the line of progress off the terminal until there is more to tell; before anything is printed.
void clear_progress();
/// A line on standard error, not across the line of progress.
void print_beside_progress(const std::string& line);

}  // namespace shvr::cli

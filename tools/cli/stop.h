#pragma once
// Ctrl-C, SIGTERM and SIGHUP (the terminal was closed) end every command with a message. SIGPIPE (the reader of the
// output is gone) ends it at once, without a message. No file is left half written. During long work (long_work.h), a
// command ends at the work's next step, with exit status 1; otherwise it ends at once, by the signal. Nothing is lost
// either way, since files appear completely or not at all. The message names the folder from which an import
// can be continued.

#include <atomic>

namespace shvr::cli {

/// Opens /dev/null for those of the descriptors 0 to 2 that are closed. Otherwise the next file to be opened would get
/// that number, and would be used as standard input or output. Call this before anything opens a file.
void open_standard_streams();

/// Installs signal handlers that print a message and end the program. Call before any command runs.
void end_in_words();

/// During its lifetime, the first signal only requests that the command end; a second Ctrl-C ends the program at once.
class StopRequest {
public:
    StopRequest();
    ~StopRequest();
    StopRequest(const StopRequest&) = delete;

    bool is_made() const { return flag(); }
    static const std::atomic<bool>& flag();
    /// Returns "stopped by Ctrl-C", "stopped by SIGTERM" or "stopped by SIGHUP".
    static const char* in_words();
};

}  // namespace shvr::cli

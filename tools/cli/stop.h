#pragma once
// Ctrl-C, SIGTERM and SIGHUP (a terminal was closed) end every command with a sentence. SIGPIPE (the reader of the
// output has left) ends it at once and silently. No file is left half written. During long work (long_work.h) a command
// ends at its next step, with exit status 1; otherwise it ends at once, by the signal. Nothing is lost, since files
// appear completely or not at all.

#include <atomic>

namespace shvr::cli {

/// Opens /dev/null on those of the descriptors 0 to 2 that are closed: a file opened later would otherwise be taken for
/// standard input or output, and printed into. Call it before anything else opens a file.
void open_standard_streams();

/// Installs the signal handlers that end the program with a sentence. Call it before any command runs.
void end_in_words();

/// During its lifetime, the first signal only asks the command to end; a second Ctrl-C ends the program at once.
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

#pragma once
// Ctrl-C and SIGTERM end every command with a sentence, and no file is left half written. While long work goes on
// (long_work.h) a command ends at its next step, with exit status 1; otherwise at once and by the signal, which loses
// nothing, since what is written appears whole or not at all.

#include <atomic>

namespace shvr::cli {

/// From now on the program ends with a sentence. Call it first.
void end_in_words();

/// While it lives the command is asked to end instead, and told once; a second Ctrl-C ends the program at once.
class StopRequest {
public:
    StopRequest();
    ~StopRequest();
    StopRequest(const StopRequest&) = delete;

    bool is_made() const { return flag(); }
    static const std::atomic<bool>& flag();
    /// "stopped by Ctrl-C" or "stopped by SIGTERM".
    static const char* in_words();
};

}  // namespace shvr::cli

#pragma once
// Ctrl-C and SIGTERM end every command with a sentence, and no file is left half written. Most commands end at once,
// which loses nothing, since what they write appears whole or not at all; the others end at their next step.

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
};

}  // namespace shvr::cli

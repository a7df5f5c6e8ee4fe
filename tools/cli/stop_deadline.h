#pragma once
// For commands that must end soon after a signal has requested it (stop.h): at the deadline, the signal ends the
// process like a kill, except that temporary files are removed. Only for work that survives a kill, such as work stored
// in a journal.

#include <chrono>

namespace shvr::cli {

/// During its lifetime, the signal ends the program if it is still running `most` after the first request, even if
/// every thread hangs. At most one instance exists.
class StopDeadline {
public:
    explicit StopDeadline(std::chrono::milliseconds most);
    ~StopDeadline();
    StopDeadline(const StopDeadline&) = delete;
};

}  // namespace shvr::cli

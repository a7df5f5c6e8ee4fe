#pragma once
// For commands that must not go on for long after a signal has asked them to end (stop.h): they end by the signal, as a
// kill would end them, but without temporary files. Only for work of which a kill loses nothing, such as that in a
// journal.

#include <chrono>

namespace shvr::cli {

/// During its lifetime, the signal ends the program if it still runs that long after the first request, even if every
/// thread hangs. At most one exists.
class StopDeadline {
public:
    explicit StopDeadline(std::chrono::milliseconds most);
    ~StopDeadline();
    StopDeadline(const StopDeadline&) = delete;
};

}  // namespace shvr::cli

#pragma once
// A disk that takes as long as a test wants, and tells who waits for it: the linker substitutes fsync, fdatasync and
// rename (-Wl,--wrap=...), with which every file and the journal reach the disk, and which are the calls that block.

#include <filesystem>
#include <functional>
#include <string>

namespace shvr::test {

class SlowDisk {
public:
    /// Counts calls of this thread, which must not wait, from now on.
    SlowDisk();
    ~SlowDisk();
    SlowDisk(const SlowDisk&) = delete;

    /// Calls on files whose names end so wait until `go_on`, or fail with that error number.
    void stop_at(const std::string& ending);
    void refuse_at(const std::string& ending, int error_number);
    void go_on();
    /// A call of another thread waits now.
    bool is_waited_for() const;
    /// Of the thread that made this.
    int calls_of_this_thread() const;
    int calls_of_others() const;
};

}  // namespace shvr::test

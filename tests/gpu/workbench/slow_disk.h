#pragma once
// A disk that takes as long as a test wants, and shows which thread waits for it: the linker substitutes fsync,
// fdatasync and rename (-Wl,--wrap=...), the calls that block and by which every file and the journal reach the disk.

#include <filesystem>
#include <functional>
#include <string>

namespace shvr::test {

class SlowDisk {
public:
    /// From now on counts calls of this thread, which must not wait.
    SlowDisk();
    ~SlowDisk();
    SlowDisk(const SlowDisk&) = delete;

    /// Makes calls on files with this name suffix wait until `go_on`, or fail with that error number.
    void stop_at(const std::string& ending);
    void refuse_at(const std::string& ending, int error_number);
    void go_on();
    /// Whether a call of another thread waits now.
    bool is_waited_for() const;
    /// Number of calls of the thread that made this object.
    int calls_of_this_thread() const;
    int calls_of_others() const;
};

}  // namespace shvr::test

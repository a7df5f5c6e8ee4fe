#pragma once
// A process that opens a project, paints, saves and closes as it is told, and can be stopped or killed at any moment.

#include <sys/types.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "engine/annotation/work/saved_files.h"

namespace shvr::test {

/// Orders to a process.
constexpr char OPEN = 'o', WORK = 'w', SAVE = 's', CLOSE = 'c', KILL = 'k';
/// Its answers. TOLD: done, with a notice of what was not as expected. PAUSED: before a call that changes files; it
/// continues at the order GO.
constexpr char DONE = 'd', TOLD = 'n', TAKEN = 't', FAILED = 'f', PAUSED = 'p', GO = 'g';

class WriterProcess {
public:
    struct Options {
        uint8_t group = 1;
        std::string host{};            ///< empty: this computer
        bool pauses = false;           ///< before each call that changes files
        bool renames_replace = false;  ///< as on NFS: there is no rename that keeps what is there
    };
    WriterProcess(const WorkFiles& files, const Options& options);
    WriterProcess(const WriterProcess&) = delete;
    ~WriterProcess();

    /// Without waiting for the answer.
    void order(char what);
    /// The next answer, or PAUSED.
    char answer();
    /// The answer to an order.
    char tell(char what);
    void kill();
    void stop() const;
    void go_on() const;

private:
    std::array<int, 2> orders_{}, answers_{};
    pid_t child_ = 0;
};

/// Whether the locks of this process can be made to fail (tests/stubs/no_locks.cpp).
bool locks_can_fail();

}  // namespace shvr::test

#pragma once
// Memory that is there when a thread with deadlines needs it. A page that is missing costs a tick microseconds where
// it is somewhere in memory, and milliseconds where it must be read from a disk; and tens of gigabytes of a scan that
// pass through memory push out what was not used for a while, as the code of a first touch is.
//
// Any thread; the calls take milliseconds at most, or as long as the disk where the program's file is not in memory.

#include <cstddef>

namespace shvr {

/// Brings a range into memory, and keeps it there for as long as this lives, as far as the system allows.
class KeptMemory {
public:
    KeptMemory(void* begin, size_t bytes) noexcept;
    ~KeptMemory();
    KeptMemory(const KeptMemory&) = delete;
    KeptMemory& operator=(const KeptMemory&) = delete;
    /// False: it is there now, but the system may take it away (RLIMIT_MEMLOCK, 8 MiB as a rule).
    bool is_kept() const { return is_kept_; }

private:
    std::byte* begin_;  ///< of its first page
    size_t bytes_;
    bool is_kept_;
};

/// The same for the program's own code and that of the libraries of C and mathematics, once for the life of the
/// process. False: see is_kept().
bool keep_code() noexcept;

}  // namespace shvr

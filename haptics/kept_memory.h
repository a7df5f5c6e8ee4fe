#pragma once
// Locks memory that a thread with deadlines needs. A page fault costs a tick microseconds if the page is still
// somewhere in memory, and milliseconds if it must be read from disk; and tens of gigabytes of a scan passing through
// memory evict pages that were not used for a while, such as the code that a first touch runs.
//
// Any thread; the calls take milliseconds at most, or the duration of disk reads if the program's file is not in
// memory.

#include <cstddef>

namespace shvr {

/// Loads a range into memory, and locks it there for this object's lifetime, as far as the system allows.
class KeptMemory {
public:
    KeptMemory(void* begin, size_t bytes) noexcept;
    ~KeptMemory();
    KeptMemory(const KeptMemory&) = delete;
    KeptMemory& operator=(const KeptMemory&) = delete;
    /// Returns false if the memory is loaded, but the system may evict it (RLIMIT_MEMLOCK, typically 8 MiB).
    bool is_kept() const { return is_kept_; }

private:
    std::byte* begin_;  ///< begin of its first page
    size_t bytes_;
    bool is_kept_;
};

/// Locks the code of the program and of the C and mathematics libraries into memory, once for the life of the process.
/// Returns false if the system may evict the code, as for is_kept().
bool keep_code() noexcept;

}  // namespace shvr

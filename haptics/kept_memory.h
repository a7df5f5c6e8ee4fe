#pragma once
// Locks memory that a thread with deadlines needs. A page fault costs a tick microseconds if the page is still
// somewhere in memory, and milliseconds if it must be read from disk. A scan of tens of gigabytes that passes through
// memory evicts pages that were not used for a while, such as the code that runs only at the first touch.
//
// Any thread; the calls take milliseconds at most, or the duration of disk reads if the program's file is not in
// memory.

#include <cstddef>

namespace shvr {

/// Loads a range into memory and locks the range there for this object's lifetime, as far as the system allows.
class KeptMemory {
public:
    KeptMemory(void* begin, size_t bytes) noexcept;
    ~KeptMemory();
    KeptMemory(const KeptMemory&) = delete;
    KeptMemory& operator=(const KeptMemory&) = delete;
    /// Returns false if the memory is loaded but not locked (RLIMIT_MEMLOCK, typically 8 MiB): it may then be evicted.
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

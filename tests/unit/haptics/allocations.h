#pragma once
// Counts the allocations of one thread, to test that the servo makes none.

#include <cstdint>

/// While set, `allocations` counts this thread's allocations.
extern constinit thread_local bool counts_allocations;
extern constinit thread_local uint64_t allocations;

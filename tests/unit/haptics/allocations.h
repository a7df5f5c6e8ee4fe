#pragma once
// Counts the allocations of one thread, for the test that the servo makes none.

#include <cstdint>

/// While it is set, `allocations` counts this thread's.
extern thread_local bool counts_allocations;
extern thread_local uint64_t allocations;

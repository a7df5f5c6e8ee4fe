#pragma once
// Measures the machine's present speed by a fixed amount of work, to distinguish it from changes of the program.

namespace shvr::bench {

/// Milliseconds that `threads` threads take for a fixed piece of arithmetic each: a few on present machines.
double yardstick_ms(int threads);

}  // namespace shvr::bench

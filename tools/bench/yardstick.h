#pragma once
// Times a fixed amount of work, to tell changes of the machine's speed from changes of the program's speed.

namespace shvr::bench {

/// Returns the milliseconds in which `threads` threads each do the same fixed arithmetic: a few at present.
double yardstick_ms(int threads);

}  // namespace shvr::bench

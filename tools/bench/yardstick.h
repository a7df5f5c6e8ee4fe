#pragma once
// Times a fixed amount of work, to tell changes of the machine's speed from changes of the program's speed.

namespace shvr::bench {

/// Returns the milliseconds that `threads` threads need for the same fixed arithmetic each; at present, a few.
double yardstick_ms(int threads);

}  // namespace shvr::bench

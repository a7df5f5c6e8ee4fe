#pragma once
// Times a fixed amount of work, to distinguish changes of the machine's speed from changes of the program's.

namespace shvr::bench {

/// Returns the milliseconds in which `threads` threads each do a fixed piece of arithmetic: a few ms at present.
double yardstick_ms(int threads);

}  // namespace shvr::bench

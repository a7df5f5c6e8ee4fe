#pragma once
// How fast the machine is now, by work that is always the same: what a change of the program is told from.

namespace shvr::bench {

/// Milliseconds that so many threads take for a fixed piece of arithmetic each, a few on a machine of today.
double yardstick_ms(int threads);

}  // namespace shvr::bench

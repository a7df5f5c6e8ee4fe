#pragma once
// Actions of a test program after its tests, before statics (including those of libraries) are destroyed.

#include <functional>

namespace shvr::test {

/// Registers an action. Actions run in reverse order.
void at_end(std::function<void()> act);

}  // namespace shvr::test

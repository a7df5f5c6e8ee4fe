#pragma once
// What a test program does after its tests and before statics are destroyed: those of libraries, too, are gone then.

#include <functional>

namespace shvr::test {

/// The last one given comes first.
void at_end(std::function<void()> act);

}  // namespace shvr::test

#pragma once
// Errors with bounds. What a test checks with these is a hard case: where SHVR_STABILITY names a file, each case's
// largest error, its bound and the input that it was found at are written there when the program ends, and
// tools/make_stability_page makes tests/STABILITY.md of them. So tests and page share the cases. One thread.

#include <string>

namespace shvr::test {

/// Fails where `error` exceeds `bound`, which may be 0, or is no number; prints both then, and with --success. The
/// input is what the test captures (CAPTURE, INFO) at that moment.
void check_below(const std::string& what, double error, double bound);

}  // namespace shvr::test

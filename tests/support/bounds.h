#pragma once
// Errors with bounds. Each check is a hard case: if SHVR_STABILITY names a file, the case's largest error, its bound
// and the worst input are written there when the program ends. tools/make_stability_page makes tests/STABILITY.md from
// them, so tests and page share the cases. One thread.

#include <string>

namespace shvr::test {

/// Fails if `error` is NaN or exceeds `bound`, which may be 0; prints both then, and with --success. The input is the
/// test's captured state (CAPTURE, INFO) at that moment.
void check_below(const std::string& what, double error, double bound);

}  // namespace shvr::test

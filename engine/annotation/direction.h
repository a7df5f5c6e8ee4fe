#pragma once

namespace shvr {

/// Which way a change record is applied: redo or undo.
enum class Direction { forwards, backwards };

}  // namespace shvr

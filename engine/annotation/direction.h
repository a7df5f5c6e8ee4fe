#pragma once

namespace shvr {

/// The direction in which a change record is applied: forwards (redo) or backwards (undo).
enum class Direction { forwards, backwards };

}  // namespace shvr

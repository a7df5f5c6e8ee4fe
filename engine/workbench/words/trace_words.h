#pragma once
// Messages about trace operations. Pure; any thread.

#include <string>

#include "engine/annotation/trace/trace_op.h"
#include "engine/annotation/work/work.h"

namespace shvr::ui {

struct TraceSize {
    size_t nodes = 0, internodes = 0;
};

/// Describes the result of an operation for the status bar. `selects`: the operation only changes the selection.
/// `done`: null if nothing was changed. `before`: size of the trace before the operation.
std::string said_of(const TraceOp& op, bool selects, const Command* done, const TraceGraph& trace,
                    const TraceSize& before);

}  // namespace shvr::ui

#pragma once
// What is said of operations of the trace. Pure; any thread.

#include <string>

#include "engine/annotation/trace/trace_op.h"
#include "engine/annotation/work/work.h"

namespace shvr::ui {

struct TraceSize {
    size_t nodes = 0, internodes = 0;
};

/// The result, for the status bar. `selects`: the operation does. `done`: null where nothing changed. `before`: how
/// much there was.
std::string said_of(const TraceOp& op, bool selects, const Command* done, const TraceGraph& trace,
                    const TraceSize& before);

}  // namespace shvr::ui

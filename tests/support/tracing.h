#pragma once
// A document that takes operations on its trace, with defaults that differ by axis.

#include "engine/annotation/trace/trace_command.h"
#include "engine/annotation/work/history.h"

namespace shvr::test {

inline const TraceDefaults TRACE_DEFAULTS{.spacing = {2.0, 3.0, 4.0}, .radius_voxels = 5.0, .group = 7};

struct Tracing {
    Document document{.mask = Mask(Size3(64)), .trace = {}};
    History history;

    const TraceGraph& trace() const { return document.trace; }
    TraceEffect effect(const TraceOp& op) const { return effect_of(op, document.trace, TRACE_DEFAULTS); }
    void perform(const TraceOp& op)
    {
        const TraceEffect made = effect(op);
        if (made.selection) document.trace.select(*made.selection);
        history.perform(document, {made.label, {made.changes.begin(), made.changes.end()}});
    }
    NodeOp node_at(const glm::dvec3& voxel) const { return {.at = voxel, .radius_voxels = {}, .group = {}}; }
};

}  // namespace shvr::test

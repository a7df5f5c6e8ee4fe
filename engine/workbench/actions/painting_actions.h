#pragma once
// Actions of the brush. The operation with which scripts paint strokes (PaintOp) is an action, too.

#include "engine/annotation/script/script.h"
#include "engine/session/session.h"
#include "engine/workbench/actions/action_row.h"

namespace shvr::ui {

class Painter;

struct Paint {  ///< begins or ends a stroke at the probe; with the trace tool, its beginning adds a node
    bool on = false;
};

inline constexpr const char* PAINTING_GROUP = "Painting";

inline constexpr auto PAINTING_ACTIONS =
    std::tuple{row<Paint, Painter>(
                   {"paint_here", "Paint at the probe", PAINTING_GROUP,
                    "begins or ends a stroke at the probe; when tracing, adds a node"},
                   [](auto& f, Paint& a) { f.flag("on", a.on, {.is_required = true}); },
                   [](const auto& model, const Paint& action) -> std::string {
                       if (!action.on) return {};
                       if (model.tool() == Tool::trace) return why_without_group(model, model.brush().group);
                       return model.stroke_is_open ? IS_PAINTING : why_not_edited(model);
                   }),
               row<PaintOp, Painter>({"paint", "Paint along a path", PAINTING_GROUP,
                                      "paints a whole stroke with a brush of its own (`density`: offsets)"},
                                     NO_FIELDS, [](const auto& model, const PaintOp&) -> std::string {
                                         return model.is_painting ? IS_PAINTING : why_not_edited(model);
                                     })};

}  // namespace shvr::ui

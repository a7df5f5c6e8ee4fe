#include "engine/workbench/bindings/tools.h"

#include <algorithm>

#include "engine/base/error.h"

namespace shvr::ui {

namespace {

constexpr ToolRow TOOL_ROWS[] = {
    {Tool::turn, "Turn", "tool_turn",
     "Drag to turn the volume. The right button zooms, and a double click puts the probe onto what is seen.", "turn",
     "zoom"},
    {Tool::paint, "Paint", "tool_paint",
     "Hold the left button to paint with the active group. The right button turns the volume.", "paint", "turn"},
    {Tool::erase, "Erase", "tool_erase",
     "Hold the left button to erase paint of any group. The right button turns the volume.", "erase", "turn"},
    {Tool::trace, "Trace", "tool_trace",
     "Click away from all nodes to add one, linked with the selected node. Click a node to select it, drag it to move "
     "it. The right button turns the volume.",
     "add / pick / drag", "turn"},
    {Tool::select, "Select", "tool_select",
     "Click a node or an internode to select it, twice for its whole segment; click paint to take its group, and empty "
     "space to deselect. The right button turns the volume.",
     "select", "turn"},
    {Tool::measure, "Measure", "tool_measure",
     "Click the points of a distance, a path or an angle, as the panel Measurements says; a double click ends a path. "
     "The right button turns the volume.",
     "set a point", "turn"},
};

}  // namespace

std::span<const ToolRow> tool_rows()
{
    return TOOL_ROWS;
}

const ToolRow& row_of(Tool tool)
{
    const auto found = std::ranges::find(TOOL_ROWS, tool, &ToolRow::tool);
    SHVR_CHECK(found != std::end(TOOL_ROWS), "tool");
    return *found;
}

std::string sentence_of(Tool tool)
{
    return sentence(row_of(tool).name, " (", mouse_in_words(tool), ")");
}

std::string mouse_in_words(Tool tool, Pane::Kind over, KeySet set)
{
    const ToolRow& row = row_of(tool);
    const char* const right = tool == Tool::turn && set == KeySet::thesis ? "paint" : row.right;
    if (over == Pane::Kind::map) return "left: turn, Shift + left or middle: move, wheel: closer or farther";
    if (over == Pane::Kind::slice && tool == Tool::turn)
        return sentence("left: set the cross-hairs, wheel: next slice, right: ", right,
                        ", middle: move, Ctrl + wheel: zoom");
    if (over == Pane::Kind::slice)
        return sentence("left: ", row.left, ", wheel: next slice, right: contrast, middle: move, Ctrl + wheel: zoom");
    if (tool == Tool::turn) return sentence("left: ", row.left, ", right: ", right, ", middle: move, wheel: zoom");
    return sentence("left: ", row.left, ", right or middle: ", row.right, ", wheel: zoom");
}

}  // namespace shvr::ui

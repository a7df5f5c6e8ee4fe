#pragma once
// Signs of tools and panels. Main thread, between the begin and the end of a frame.

#include <string_view>

#include "engine/workbench/bindings/tools.h"
#include "ui/panels/signs/pen.h"

namespace shvr::ui {

void draw_sign(Tool tool, const Pen& pen);
void draw_clip_box(const Pen& pen);
void draw_cut_plane(const Pen& pen);
/// `panel`: an id of engine/workbench/appearance/panel_rows.h; draws nothing for another.
void draw_sign(std::string_view panel, const Pen& pen);

}  // namespace shvr::ui

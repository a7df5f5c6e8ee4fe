#pragma once
// Small pictures of the projects opened last, drawn from the font atlas, which holds them next to the characters: so
// they need no texture of their own. A thread reads their files. Main thread.

#include <filesystem>
#include <span>

#include <imgui/imgui.h>

namespace shvr::ui {

/// Sets the folder of the pictures (engine/workbench/models/project_picture.h); empty: there are none.
void set_thumbnail_folder(const std::filesystem::path& folder);
/// Requests the pictures of these paths. They can be drawn some frames later, if their files are there. `again`: the
/// files may have changed since.
void want_thumbnails(std::span<const std::filesystem::path> paths, bool again);
/// Returns whether pictures have been read that the atlas lacks: then set_style has to be called.
bool thumbnails_are_stale();
/// Returns whether files are being read, so that another frame is needed.
bool thumbnails_are_read();
/// Adds the pictures to the atlas, which has its fonts but is not built yet, and builds it.
void build_with_thumbnails(ImFontAtlas& atlas);
/// Draws the picture of a path over a rectangle. Returns false, and draws nothing, if there is none.
bool draw_thumbnail(const std::filesystem::path& path, const ImVec2& begin, const ImVec2& end);

}  // namespace shvr::ui

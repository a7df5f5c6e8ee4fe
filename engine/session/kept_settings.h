#pragma once
// The settings of a session that are restored on opening but are neither part of the work nor undoable: cameras and the
// current camera, rendering, panes, the window's settings, probe and brush. The journal stores them
// (Work::keep_settings), like the lasting settings (lasting_settings.h); every setting that a user changes belongs to
// one of the two groups. Any thread.

#include "engine/annotation/settings.h"
#include "engine/session/session.h"

namespace shvr {

/// The JSON of each section, as in a session file; the section "cameras" includes both `camera` and `cameras`.
SettingValues kept_settings(const Session& session);
/// Sets the sections of `values`; others stay. Fails, changing nothing, if a section cannot be read.
void set_kept_settings(Session& session, const SettingValues& values);
/// Returns `values` as this version of the program writes them. Fails like set_kept_settings.
SettingValues normalized_kept_settings(const SettingValues& values);
/// Copies the members that the kept settings cover.
void take_kept_sections(Session& to, const Session& from);

}  // namespace shvr

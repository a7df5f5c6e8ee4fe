#pragma once
// The settings of a session that are restored on opening but are neither undoable nor part of the work: cameras and the
// current camera, looks kept with views, rendering, panes, the window's settings, probe and brush. Together with the
// lasting settings (lasting_settings.h) they cover every setting that a user can change. The journal stores both
// (Work::keep_settings). Any thread.

#include "engine/annotation/settings.h"
#include "engine/session/session.h"

namespace shvr {

/// Returns the JSON of each section, as in a session file. The section "cameras" has both `camera` and `cameras`.
SettingValues kept_settings(const Session& session);
/// Sets the sections in `values`, and leaves others unchanged. If a section cannot be read, fails and changes nothing.
void set_kept_settings(Session& session, const SettingValues& values);
/// Returns `values` in the form in which this version writes them. Fails like set_kept_settings.
SettingValues normalized_kept_settings(const SettingValues& values);
/// Copies the members that the kept settings cover.
void take_kept_sections(Session& to, const Session& from);

}  // namespace shvr

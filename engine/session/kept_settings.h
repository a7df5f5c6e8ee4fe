#pragma once
// What of a session comes back as it was left, but is no work and not undone: cameras and the one in use, how pictures
// are made, panes, the window's settings, probe and brush. The journal holds it (Work::keep_settings) as the lasting
// settings (lasting_settings.h), between which and this everything is divided that a person changes. Any thread.

#include "engine/annotation/settings.h"
#include "engine/session/session.h"

namespace shvr {

/// The JSON of each section, as a session file holds it; "cameras" holds both `camera` and `cameras`.
SettingValues kept_settings(const Session& session);
/// Sets the sections of `values`; others stay. Fails, changing nothing, where one cannot be read.
void set_kept_settings(Session& session, const SettingValues& values);
/// `values` as this version of the program writes them. Fails like set_kept_settings.
SettingValues normalized_kept_settings(const SettingValues& values);
/// Copies the members that these sections are about.
void take_kept_sections(Session& to, const Session& from);

}  // namespace shvr

#pragma once
// The settings of a session that are part of the user's work and undoable like paint: the transfer function, groups,
// light, blending, cuts, measured distances, background, saturation and smooth borders. Cameras, panes and the probe
// are not (kept_settings.h). Any thread.

#include "engine/annotation/settings.h"
#include "engine/session/session.h"

namespace shvr {

/// The JSON of each section, as in a session file: colours are rounded to the 8 bits of their spelling. "picture" has
/// the keys of a file's `render` that affect the picture's look rather than how it is computed.
SettingValues lasting_settings(const Session& session);
/// Sets the sections of `values`; others stay. Fails, changing nothing, if a section cannot be read.
void set_lasting_settings(Session& session, const SettingValues& values);
/// Returns `values` as this version of the program writes them. Fails like set_lasting_settings.
SettingValues normalized_settings(const SettingValues& values);
/// Returns `values`, lasting or kept settings, without the sections that the "key=value" `settings` set.
SettingValues without_overridden(SettingValues values, const std::vector<std::string>& settings);
/// Copies the members that "picture" covers.
void take_picture(RenderSettings& to, const RenderSettings& from);
/// Describes the differences: "light: ambient 0.2 to 0.3", "groups: 3 color" or "transfer function".
std::string difference_of(const SettingValues& before, const SettingValues& after);

}  // namespace shvr

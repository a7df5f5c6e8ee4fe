#pragma once
// The settings of a session that are part of the user's work, and undoable like paint: the transfer function, groups,
// light, blending, cuts, measured distances, background, saturation and smooth borders. All other settings, such as
// cameras, panes and the probe, are in kept_settings.h. Any thread.

#include "engine/annotation/settings.h"
#include "engine/session/session.h"

namespace shvr {

/// Returns the JSON of each section, as in a session file; colours are rounded to 8 bits. "picture" has those keys of a
/// file's `render` that affect the look of a picture rather than how it is computed.
SettingValues lasting_settings(const Session& session);
/// Sets the sections in `values`, and leaves others unchanged. If a section cannot be read, fails and changes nothing.
void set_lasting_settings(Session& session, const SettingValues& values);
/// Returns `values` in the form in which this version writes them. Fails like set_lasting_settings.
SettingValues normalized_settings(const SettingValues& values);
/// Returns `values`, lasting or kept settings, without the sections that `settings` ("key=value") override.
SettingValues without_overridden(SettingValues values, const std::vector<std::string>& settings);
/// Copies the members that "picture" covers.
void take_picture(RenderSettings& to, const RenderSettings& from);

}  // namespace shvr
